/* SPDX-License-Identifier: Apache-2.0 */
/* The energy of cloth bent to a cylinder. spec/validation.md §3 */
#include "validate/validate.h"

#include <math.h>

static const double bow = 10, stiffness = 1e-4; /* 1/m, N·m */

/* The energy of a sheet of m × n particles bent in the direction `way`. Its arc
 * is kept and its plane's stiffness next to nothing, so that it is bending. */
static double whole(const struct validate *v, int m, int n, double h,
                    double way)
{
    struct sheet s;
    double c = cos(way), d = sin(way);
    sheet_make(v, &s, m, n, h);
    s.cloth.material.bend = stiffness;
    s.cloth.material.stretch = 1e-9;
    s.cloth.material.shear = 3e-10;
    for (int64_t p = 0; p < s.n; p++) {
        double a = h * (double)(p % m), b = h * (double)(p / m);
        double along = c * a + d * b, across = c * b - d * a;
        s.x[p][0] = sin(bow * along) / bow;
        s.x[p][1] = across;
        s.x[p][2] = (1 - cos(bow * along)) / bow;
    }
    double energy = sheet_energy(&s);
    sheet_free(&s);
    return energy;
}

/* The energy by area of one cell inside, over ½ D κ²: every cell of a cylinder
 * is like any other but for a turn, so borders and corners cancel in this
 * difference of four sheets. */
static double inner(const struct validate *v, double h, double way)
{
    enum { N = 7 };
    double energy = whole(v, N + 1, N + 1, h, way) -
                    whole(v, N + 1, N, h, way) - whole(v, N, N + 1, h, way) +
                    whole(v, N, N, h, way);
    return energy / (stiffness * bow * bow / 2 * h * h);
}

void part_cylinder(struct validate *v)
{
    static const double degrees[] = {0, 15, 22.5, 30, 45, 60, 90, 135};
    static const double turn[SIZES] = {0.1, 0.05, 0.025, 0.0125}; /* κh */
    for (int k = 0; k < 8; k++) {
        char name[96];
        bool all = v->bits == 64;
        snprintf(name, sizeof name, "bent at %g degrees to warp%s", degrees[k],
                 all ? "" : "; whole sheet over that of binary64");
        struct property p = {.part = "cylinder",
                             .name = name,
                             .unit = "of ½Dκ²",
                             .theory = 1,
                             .bar = all ? 0.01 : 0.02,
                             .share = true,
                             .up_to = 0.05 / bow,
                             .promised = true};
        double way = degrees[k] * acos(-1) / 180;
        for (int c = 0; c < SIZES; c++) {
            double h = turn[c] / bow;
            if (all) {
                property_add(&p, h, inner(v, h, way));
                continue;
            }
            /* The difference of four sheets would lose all of 24 bits. */
            struct validate fine = *v;
            fine.bits = 64;
            property_add(
                &p, h, whole(v, 20, 20, h, way) / whole(&fine, 20, 20, h, way));
        }
        property_end(v, &p);
    }
}
