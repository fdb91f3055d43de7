/* SPDX-License-Identifier: Apache-2.0 */
/* Coarse sheets that strike a drum of fine facets, by the public API: no impact
 * gives energy, by whatever integrator. spec/contact/lagrange.md §5 */
#include "tests/base/harness.h"

enum { FACETS = 512, M = 7, N = 4 };

struct strike {
    drape_def def;
    drape_cloth cloth;
    drape_obstacle drum;
    double x[M * N][3], v[M * N][3];
    double rim[2 * FACETS][3];
    int32_t tri[2 * FACETS][3];
};

/* A sheet with cells of 50 mm, 4 mm over a drum of 100 mm radius, of which a
 * cell meets some forty facets; it falls at 2 m/s. */
static void make_strike(struct strike *s, int integrator, double stretch)
{
    drape_default(&s->def);
    drape_default_cloth(&s->cloth);
    drape_default_obstacle(&s->drum);
    for (int k = 0; k < FACETS; k++) {
        double angle = 2 * 3.14159265358979323846 * k / FACETS;
        int32_t a = 2 * k, b = 2 * ((k + 1) % FACETS);
        for (int side = 0; side < 2; side++) {
            s->rim[a + side][0] = 0.1 * cos(angle);
            s->rim[a + side][1] = 0.1 * sin(angle);
            s->rim[a + side][2] = side ? 0.2 : -0.2;
        }
        memcpy(s->tri[2 * k], (int32_t[]){a, b, a + 1}, sizeof *s->tri);
        memcpy(s->tri[2 * k + 1], (int32_t[]){b, b + 1, a + 1}, sizeof *s->tri);
    }
    for (int k = 0; k < M * N; k++) {
        s->x[k][0] = 0.05 * (k % M) - 0.15;
        s->x[k][1] = 0.104;
        s->x[k][2] = 0.05 * (k / M) - 0.0737;
        s->v[k][1] = -2;
    }
    s->drum.n_vertices = 2 * FACETS;
    s->drum.n_triangles = 2 * FACETS;
    s->drum.x = (const double(*)[3])s->rim;
    s->drum.tri = (const int32_t(*)[3])s->tri;
    s->cloth.m = M;
    s->cloth.n = N;
    s->cloth.width = 0.05 * (M - 1);
    s->cloth.height = 0.05 * (N - 1);
    s->cloth.x = (const double(*)[3])s->x;
    s->cloth.velocity = (const double(*)[3])s->v;
    s->cloth.material.stretch = stretch;
    s->cloth.material.shear = 0.3 * stretch;
    s->def.precision = REAL_BITS;
    s->def.integrator = integrator;
    s->def.dt = 1.0 / 120;
    s->def.sleep = 0;
    s->def.cloths = &s->cloth;
    s->def.n_cloths = 1;
    s->def.obstacles = &s->drum;
    s->def.n_obstacles = 1;
}

/* The largest energy after a step in an eighth of a second over that of the
 * start, which impacts and the integrator take from; or a status below 0. */
static double gain(int integrator, double stretch)
{
    static struct strike s;
    drape_world *world = NULL;
    drape_step_report report;
    double most = 0;
    make_strike(&s, integrator, stretch);
    double mass = s.cloth.material.density * s.cloth.width * s.cloth.height;
    double start = mass * (2 * 2 / 2.0 + 9.81 * 0.104);
    int status = drape_create(&s.def, &world, NULL);
    for (int k = 0; k < 15 && status == DRAPE_OK; k++) {
        status = drape_step(world, &report);
        double now = report.kinetic + report.elastic + report.potential;
        most = fmax(most, now / start);
    }
    drape_destroy(world);
    return status == DRAPE_OK ? most : status;
}

const char *test_strike_energy(void)
{
    static const int method[] = {DRAPE_BW, DRAPE_CK, DRAPE_BDF2};
    static const double stretch[] = {1, 10, 1000};
    for (int k = 0; k < 9; k++) {
        double most = gain(method[k % 3], stretch[k / 3]);
        EXPECT(most > 0 && most <= 1);
        ran(1);
    }
    return NULL;
}
