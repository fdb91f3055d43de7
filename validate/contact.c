/* SPDX-License-Identifier: Apache-2.0 */
/* A sheet on a slope. spec/validation.md §9 */
#include "validate/validate.h"

#include <math.h>
#include <stdlib.h>

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
 * way from rest; the first tenth is left out, as it falls onto the plane.
 * *most: the largest quotient of friction and normal force of a contact in a
 * step. */
static double slide(const struct validate *v, const struct slope *t, double h,
                    double *most)
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
        *most = sheet_steepest(world, *most);
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

void part_contact(struct validate *v)
{
    static const double cell[SIZES] = {0.04, 0.02, 0.4 / 30, 0.01};
    int sizes = v->bits == 64 ? SIZES : SIZES - 1;
    static const struct slope kinds[] = {{20, 0, 1},   {20, 0.2, 1},
                                         {20, 0.3, 1}, {20, 0.5, 1},
                                         {20, 0, 2},   {20, 0.2, 2}};
    if (v->quick)
        return;
    for (int k = 0; k < 6; k++) {
        const struct slope *t = &kinds[k];
        char name[96], other[192];
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
        snprintf(other, sizeof other,
                 "slope of 20 degrees; friction %g%s; largest quotient of a "
                 "contact in a step; over its coefficient",
                 t->friction, t->triangles > 1 ? "; two triangles" : "");
        struct property cone = {.part = "contact",
                                .name = other,
                                .unit = "1",
                                .theory = 1,
                                .bar = 1e-3,
                                .promised = true,
                                .up_to = 1};
        for (int c = 0; c < sizes; c++) {
            double most = 0;
            property_add(&p, cell[c], slide(v, t, cell[c], &most));
            property_add(&cone, cell[c], fmax(1, most / t->friction));
        }
        property_end(v, &p);
        if (t->friction > 0)
            property_end(v, &cone);
    }
}
