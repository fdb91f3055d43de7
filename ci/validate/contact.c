/* SPDX-License-Identifier: Apache-2.0 */
/* A sheet on a slope, and two sheets that meet. spec/validation.md §9 */
#include "ci/validate/validate.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The mean way and speed of the first n vertices down a slope of cosine c and
 * sine d. */
static void downhill(const drape_world *world, int64_t n, double c, double d,
                     double out[2])
{
    size_t all = (size_t)drape_vertices(world);
    double(*x)[3] = take(all, sizeof *x), (*u)[3] = take(all, sizeof *u);
    drape_read(world, x, u);
    out[0] = out[1] = 0;
    for (int64_t p = 0; p < n; p++) {
        out[0] -= (c * x[p][0] + d * x[p][1]) / (double)n;
        out[1] -= (c * u[p][0] + d * u[p][1]) / (double)n;
    }
    free(x);
    free(u);
}

struct slope {
    double degrees, friction;
    int triangles; /* of the plane: 1 or 2 */
};

/* How far a sheet of 0.4 m slides down a plane in half a second, over Coulomb's
 * way from rest; the first tenth is left out, as it falls onto the plane. */
static double slide(const struct validate *v, const struct slope *t, double h)
{
    struct sheet s;
    double a = t->degrees * acos(-1) / 180, c = cos(a), d = sin(a);
    int m = (int)(0.4 / h + 0.5) + 1;
    sheet_make(v, &s, m, m, h);
    /* The plane is turned about z, the sheet at its thickness above it. */
    double gap = 1.001 * fmin(s.cloth.material.thickness, h / 2);
    for (int p = 0; p < s.n; p++) {
        double along = h * (p % m), across = h * (p / m) - 0.2;
        s.x[p][0] = c * along - d * gap;
        s.x[p][1] = d * along + c * gap;
        s.x[p][2] = across;
    }
    const double corner[5][3] = {{-9 * c, -9 * d, -9},
                                 {9 * c, 9 * d, -9},
                                 {9 * c, 9 * d, 9},
                                 {-9 * c, -9 * d, 9},
                                 {-9 * c, -9 * d, 40}};
    /* One triangle under the sheet, or two whose edge is under it. */
    const int32_t tri[2][3] = {{0, t->triangles == 1 ? 4 : 2, 1}, {0, 3, 2}};
    drape_obstacle plane;
    drape_default_obstacle(&plane);
    plane.n_vertices = 5;
    plane.n_triangles = t->triangles;
    plane.x = corner;
    plane.tri = tri;
    plane.friction = s.cloth.material.friction = t->friction;
    s.def.obstacles = &plane;
    s.def.n_obstacles = 1;
    s.def.max_slices = 32;
    s.def.tolerance = 1e-5;
    double dt = 1.0 / 60, way[2] = {NAN, NAN}, speed = 0;
    drape_world *world = sheet_world(&s, dt);
    for (int k = 1; world && k <= 36; k++) {
        if (drape_step(world, NULL) != DRAPE_OK)
            break;
        if (k != 6 && k != 36)
            continue;
        double mean[2];
        downhill(world, s.n, c, d, mean);
        way[k == 36] = mean[0];
        speed = k == 6 ? mean[1] : speed;
    }
    drape_destroy(world);
    sheet_free(&s);
    double time = 0.5, pull = 9.81 * (d - t->friction * c);
    double due = speed * time + pull * time * (time + dt) / 2;
    return pull > 0 ? (way[1] - way[0]) / due : way[1] - way[0];
}

struct meeting {
    double most;            /* the largest energy of a step, over the start's */
    double linear, angular; /* momentum lost, as a share */
};

/* Momentum, the angular one about the origin, of sheets of m² particles. */
static void momentum(const double *mass, int64_t n, double (*x)[3],
                     double (*u)[3], double p[3], double l[3])
{
    memset(p, 0, 3 * sizeof *p);
    memset(l, 0, 3 * sizeof *l);
    for (int64_t k = 0; k < n; k++)
        for (int c = 0; c < 3; c++) {
            int a = (c + 1) % 3, b = (c + 2) % 3;
            p[c] += mass[k] * u[k][c];
            l[c] += mass[k] * (x[k][a] * u[k][b] - x[k][b] * u[k][a]);
        }
}

enum { MOST = 2 * 41 * 41 };
static double place[MOST][3], speed_of[MOST][3], mass[MOST];

/* Two sheets of m² particles of 0.4 m, 15 mm apart and 0.1 m aside, meet at 1
 * m/s each: the upper one is `ratio` times as heavy and as slow. Returns their
 * kinetic energy. */
static double meet_start(int m, double h, double ratio)
{
    double energy = 0;
    for (int k = 0; k < 2 * m * m; k++) {
        int upper = k >= m * m, i = k % (m * m) % m, j = k % (m * m) / m;
        place[k][0] = h * i + 0.1 * upper - 0.2;
        place[k][1] = 0.015 * upper;
        place[k][2] = h * j - 0.2;
        memset(speed_of[k], 0, sizeof speed_of[k]);
        speed_of[k][1] = upper ? -1 / ratio : 1;
        mass[k] = 0.2 * (upper ? ratio : 1) * h * h;
        mass[k] *= (i == 0 || i == m - 1) ? 0.5 : 1;
        mass[k] *= (j == 0 || j == m - 1) ? 0.5 : 1;
        energy += mass[k] * speed_of[k][1] * speed_of[k][1] / 2;
    }
    return energy;
}

/* Their world, in empty space. */
static drape_world *meet_world(const struct validate *v, int m, double h,
                               double ratio)
{
    struct sheet s;
    sheet_make(v, &s, m, m, h);
    drape_cloth cloth[2] = {s.cloth, s.cloth};
    for (int k = 0; k < 2; k++) {
        cloth[k].x = (const double(*)[3])(place + k * m * m);
        cloth[k].velocity = (const double(*)[3])(speed_of + k * m * m);
        cloth[k].material.density *= k ? ratio : 1;
    }
    s.def.cloths = cloth;
    s.def.n_cloths = 2;
    s.def.self_collision = 1;
    s.def.max_slices = 32;
    s.def.tolerance = 1e-5;
    memset(s.def.gravity, 0, sizeof s.def.gravity);
    drape_world *world;
    drape_error error;
    if (drape_create(&s.def, &world, &error) != DRAPE_OK)
        fprintf(stderr, "validate: %s\n", error.text);
    sheet_free(&s);
    return world;
}

static struct meeting meet(const struct validate *v, double h, double ratio)
{
    struct meeting out = {NAN, NAN, NAN};
    int m = (int)(0.4 / h + 0.5) + 1, n = 2 * m * m;
    double start = meet_start(m, h, ratio), p[2][3], l[2][3];
    drape_world *world = meet_world(v, m, h, ratio);
    if (!world)
        return out;
    momentum(mass, n, place, speed_of, p[0], l[0]);
    out.most = 1;
    for (int k = 0; k < 12; k++) {
        drape_step_report report;
        bool good = drape_step(world, &report) == DRAPE_OK;
        double energy = good ? report.kinetic + report.elastic : NAN;
        out.most = energy / start <= out.most ? out.most : energy / start;
    }
    drape_read(world, place, speed_of);
    momentum(mass, n, place, speed_of, p[1], l[1]);
    double dp = 0, dl = 0, turn = 0, scale = 0.2 * 0.16; /* of one sheet */
    for (int c = 0; c < 3; c++) {
        dp += pow(p[1][c] - p[0][c], 2);
        dl += pow(l[1][c] - l[0][c], 2);
        turn += pow(l[0][c], 2);
    }
    out.linear = sqrt(dp) / scale;
    out.angular = sqrt(dl / turn);
    drape_destroy(world);
    return out;
}

static void slopes(struct validate *v, const double *cell, int sizes)
{
    static const struct slope kinds[] = {{20, 0, 1},   {20, 0.2, 1},
                                         {20, 0.3, 1}, {20, 0.5, 1},
                                         {20, 0, 2},   {20, 0.2, 2}};
    for (int k = 0; k < 6; k++) {
        const struct slope *t = &kinds[k];
        char name[96];
        bool rests = t->friction > tan(t->degrees * acos(-1) / 180);
        snprintf(name, sizeof name, "slope of 20 degrees; friction %g; %s%s",
                 t->friction, rests ? "way in 0.5 s" : "way over Coulomb's",
                 t->triangles > 1 ? "; two triangles" : "");
        struct property p = {.part = "contact",
                             .name = name,
                             .unit = rests ? "m" : "1",
                             .theory = !rests,
                             .bar = rests ? 1e-3 : 0.02,
                             .promised = true,
                             .up_to = 1};
        for (int c = 0; c < sizes; c++)
            property_add(&p, cell[c], slide(v, t, cell[c]));
        property_end(v, &p);
    }
}

void part_contact(struct validate *v)
{
    static const double cell[SIZES] = {0.04, 0.02, 0.4 / 30, 0.01};
    static const char *const what[] = {"largest energy over the start's",
                                       "linear momentum lost",
                                       "angular momentum lost"};
    int sizes = v->bits == 64 ? SIZES : SIZES - 1;
    if (v->quick)
        return;
    slopes(v, cell, sizes);
    for (int r = 1; r <= 10; r *= 10) {
        struct property p[3];
        char name[3][96];
        for (int q = 0; q < 3; q++) {
            snprintf(name[q], sizeof name[q], "two sheets; %d to 1; %s", r,
                     what[q]);
            p[q] = (struct property){.part = "contact",
                                     .name = name[q],
                                     .unit = "1",
                                     .theory = q ? 0 : 1,
                                     .bar = 0.01,
                                     .up_to = 1};
        }
        for (int c = 0; c < sizes; c++) {
            struct meeting m = meet(v, cell[c], r);
            property_add(&p[0], cell[c], m.most);
            property_add(&p[1], cell[c], m.linear);
            property_add(&p[2], cell[c], m.angular);
        }
        for (int q = 0; q < 3; q++)
            property_end(v, &p[q]);
    }
}
