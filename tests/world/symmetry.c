/* SPDX-License-Identifier: Apache-2.0 */
/* Symmetries of whole steps, to the last bit: a body far away, a mirror image,
 * or an exchange of two axes does not change the motion. */
#include <stdlib.h>

#include "tests/solve/system.h"
#include "tests/world/slab.h"

enum { SIDE = 12, COUNT = SIDE * SIDE, STEPS = 8 };

/* An uneven sheet thrown over a moving slab, given by its positions. */
struct thrown {
    struct slab d;
    drape_cloth cloth[2];
    drape_obstacle obstacle[2];
    drape_pin pin[COUNT + 2];
    double x[COUNT][3], v[COUNT][3], corner[8][3], way[2][3];
};

static void make_thrown(struct thrown *s, int integrator)
{
    static const double time[2] = {0, 1};
    memset(s, 0, sizeof *s);
    slab_make(&s->d, integrator);
    s->d.def.dt = integrator < DRAPE_BW ? 0x1p-9 : 0x1p-6;
    s->d.def.precond = DRAPE_JACOBI; /* multigrid rounds directions by axis */
    s->d.def.gravity[0] = 1;
    s->d.def.gravity[2] = 0.5;
    s->d.def.wind = (drape_wind){
        .velocity = {1, 2, 3}, .density = 1.2, .drag = 1, .lift = 0.3};
    s->way[1][0] = 0.2;
    s->way[1][1] = 0.3;
    s->d.motion = (drape_motion){
        .keys = 2, .time = time, .position = (const double(*)[3])s->way};
    s->d.cloth.m = s->d.cloth.n = SIDE;
    s->d.cloth.width = s->d.cloth.height = (SIDE - 1) / 64.0;
    for (int k = 0; k < COUNT; k++) {
        uint64_t seed = 6 * (uint64_t)k;
        s->x[k][0] = k % SIDE / 64.0 - 0.08 + 1e-3 * noise_of(seed);
        s->x[k][1] = 0.11 + 1e-3 * noise_of(seed + 1);
        s->x[k][2] = (double)(k / SIDE) / 64 - 0.08 + 1e-3 * noise_of(seed + 2);
        for (int i = 0; i < 3; i++)
            s->v[k][i] = 0.2 * noise_of(seed + 3 + (uint64_t)i) - (i == 1);
    }
    memcpy(s->corner, s->d.obstacle.x, sizeof s->corner);
    s->d.cloth.x = (const double(*)[3])s->x;
    s->d.cloth.velocity = (const double(*)[3])s->v;
    s->d.obstacle.x = (const double(*)[3])s->corner;
    s->pin[0] = (drape_pin){2, 3, -1};
    s->pin[1] = (drape_pin){9, 7, 0};
    s->d.cloth.pins = s->pin;
    s->d.cloth.n_pins = 2;
}

/* Reads x and v of a body's vertices after a step. */
static void read_body(const drape_world *world, int body, double (*x)[3],
                      double (*v)[3])
{
    size_t nv = (size_t)drape_vertices(world);
    int64_t first = drape_first_vertex(world, body);
    size_t n = (size_t)(drape_first_vertex(world, body + 1) - first);
    double(*all)[3] = malloc(2 * nv * sizeof *all);
    if (!all)
        abort();
    drape_read(world, all, all + nv);
    memcpy(x, all + first, n * sizeof *x);
    memcpy(v, all + nv + first, n * sizeof *v);
    free(all);
}

/* A body far away: adds a pinned sheet, before or after the scene's own sheet
 * in the order of bodies, with a slab beside it. Returns the index of the
 * scene's own sheet. */
static int add_far(struct thrown *s, bool before)
{
    for (int k = 0; k < COUNT; k++)
        s->pin[2 + k] = (drape_pin){k % SIDE, k / SIDE, -1};
    for (int k = 0; k < 2; k++) {
        bool far = (k == 0) == before;
        s->cloth[k] = s->d.cloth;
        s->obstacle[k] = s->d.obstacle;
        if (!far)
            continue;
        s->cloth[k].x = s->cloth[k].velocity = NULL;
        s->cloth[k].origin[0] = 64;
        s->cloth[k].pins = s->pin + 2;
        s->cloth[k].n_pins = COUNT;
        s->obstacle[k].motion = -1;
    }
    static double away[8][3];
    for (int k = 0; k < 8; k++) {
        memcpy(away[k], s->corner[k], sizeof away[k]);
        away[k][2] += 64;
    }
    s->obstacle[before ? 0 : 1].x = (const double(*)[3])away;
    s->d.def.cloths = s->cloth;
    s->d.def.obstacles = s->obstacle;
    s->d.def.n_cloths = s->d.def.n_obstacles = 2;
    return before ? 1 : 0;
}

static const char *check_bystander(int integrator, bool before)
{
    static struct thrown s[2];
    static double x[2][COUNT][3], v[2][COUNT][3];
    drape_world *world[2];
    drape_step_report r[2];
    int64_t contacts = 0;
    int body[2] = {0, 0};
    for (int k = 0; k < 2; k++) {
        make_thrown(&s[k], integrator);
        if (k)
            body[k] = add_far(&s[k], before);
        world[k] = slab_world(&s[k].d);
        EXPECT(world[k]);
    }
    for (int step = 0; step < STEPS; step++) {
        for (int k = 0; k < 2; k++) {
            EXPECT(drape_step(world[k], &r[k]) == DRAPE_OK);
            read_body(world[k], body[k], x[k], v[k]);
        }
        EXPECT(!memcmp(x[0], x[1], sizeof x[0]));
        EXPECT(!memcmp(v[0], v[1], sizeof v[0]));
        EXPECT(r[0].contacts == r[1].contacts && r[0].rounds == r[1].rounds);
        EXPECT(!(r[0].outcome & DRAPE_DIVERGED));
        contacts += r[0].contacts;
        ran(1);
    }
    EXPECT(contacts > 0);
    drape_destroy(world[0]);
    drape_destroy(world[1]);
    return NULL;
}

const char *test_world_bystander(void)
{
    const char *failed = NULL;
    for (int k = 0; k < 4 && !failed; k++) {
        /* implicit methods solve all cloths together: lagrange.md §3.2 */
        static const int some[] = {DRAPE_EULER, DRAPE_VERLET};
        failed = check_bystander(some[k / 2], k % 2);
    }
    return failed;
}

/* Mirrors and exchanged axes: how a view maps a point, as the axis of each
 * coordinate and its sign. */
struct view {
    int axis[3];
    double sign[3];
};

static void look(const struct view *w, double x[3])
{
    double y[3];
    for (int i = 0; i < 3; i++)
        y[i] = w->sign[i] * x[w->axis[i]];
    memcpy(x, y, sizeof y);
}

static void look_all(const struct view *w, struct thrown *s)
{
    for (int k = 0; k < COUNT; k++) {
        look(w, s->x[k]);
        look(w, s->v[k]);
    }
    for (int k = 0; k < 8; k++)
        look(w, s->corner[k]);
    look(w, s->way[1]);
    look(w, s->d.def.gravity);
    look(w, s->d.def.wind.velocity);
}

static const char *check_view(const struct view *w, int integrator)
{
    static struct thrown s[2];
    static double x[2][COUNT][3], v[2][COUNT][3];
    drape_world *world[2];
    int64_t contacts = 0;
    for (int k = 0; k < 2; k++) {
        make_thrown(&s[k], integrator);
        if (k)
            look_all(w, &s[k]);
        world[k] = slab_world(&s[k].d);
        EXPECT(world[k]);
    }
    for (int step = 0; step < STEPS; step++) {
        for (int k = 0; k < 2; k++) {
            drape_step_report r;
            EXPECT(drape_step(world[k], &r) == DRAPE_OK);
            read_body(world[k], 0, x[k], v[k]);
            contacts += r.contacts;
        }
        for (int p = 0; p < COUNT; p++) {
            look(w, x[0][p]);
            look(w, v[0][p]);
            for (int i = 0; i < 3; i++)
                EXPECT(x[0][p][i] == x[1][p][i] && v[0][p][i] == v[1][p][i]);
        }
        ran(1);
    }
    EXPECT(contacts > 0);
    drape_destroy(world[0]);
    drape_destroy(world[1]);
    return NULL;
}

/* Mirrors work with every method. Axes are exchanged only with methods that
 * factor no block, since a factorisation starts with x. */
const char *test_world_mirror(void)
{
    static const struct view all[] = {{{0, 1, 2}, {-1, 1, 1}},
                                      {{0, 1, 2}, {1, -1, 1}},
                                      {{0, 1, 2}, {1, 1, -1}},
                                      {{1, 0, 2}, {1, 1, 1}}};
    static const int some[] = {DRAPE_EULER, DRAPE_VERLET, DRAPE_BW, DRAPE_CK};
    const char *failed = NULL;
    for (int k = 0; k < 14 && !failed; k++)
        failed = check_view(&all[k < 12 ? k / 4 : 3], some[k % 4]);
    return failed;
}
