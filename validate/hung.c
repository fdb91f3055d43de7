/* SPDX-License-Identifier: Apache-2.0 */
/* The largest strain of a sheet that hangs by two corners.
 * spec/validation.md §8 */
#include "validate/validate.h"

#include <math.h>

/* A square of 0.5 m of the default cotton. The strain at a corner grows as the
 * cells shrink, since a point holds a finite force there. */
static double largest(const struct validate *v, double limit, double h)
{
    struct sheet s;
    int m = (int)(0.5 / h + 0.5) + 1;
    sheet_make(v, &s, m, m, h);
    for (int k = 0; k < 3; k++)
        s.cloth.material.limit[k] = k == 2 ? 2 * limit : limit;
    s.def.newton = limit > 0 ? 8 : 1; /* long steps pass the limit at once */
    for (int64_t p = 0; p < s.n; p++) /* the corners 5 % nearer, and a sag */
        s.x[p][0] *= 0.95;
    sheet_pin(&s, 0, 0);
    sheet_pin(&s, m - 1, 0);
    for (int64_t p = 0; p < s.n; p++)
        s.x[p][2] = 0.01 * sin(9 * s.x[p][0]) * (1 + s.x[p][1]);
    bool found = sheet_rest(&s, v->bits == 64 ? 1e-5 : 1e-4);
    double most = 0;
    for (int p = 0; p < s.n; p++)
        for (int k = 0; k < 2; k++) {
            int q = p + (k ? m : 1);
            if (k ? q >= s.n : q % m == 0)
                continue;
            double d =
                hypot(hypot(s.x[p][0] - s.x[q][0], s.x[p][1] - s.x[q][1]),
                      s.x[p][2] - s.x[q][2]);
            most = fmax(most, 100 * (d / h - 1));
        }
    sheet_free(&s);
    return found ? most : NAN;
}

void part_hung(struct validate *v)
{
    static const double cell[SIZES] = {0.05, 0.025, 0.0125, 0.00625};
    for (int limited = 0; limited < 2 && !v->quick; limited++) {
        struct property p = {.part = "hung",
                             .name = limited ? "largest strain; limit of 5 %"
                                             : "largest strain; by two corners",
                             .unit = "%",
                             .theory = 0,
                             .bar = limited ? 5.5 : 5,
                             .up_to = limited,
                             .promised = limited};
        for (int k = 0; k < SIZES; k++)
            property_add(&p, cell[k], largest(v, limited * 0.05, cell[k]));
        property_end(v, &p);
    }
}
