/* SPDX-License-Identifier: Apache-2.0 */
/* Conservative bisection of a collision query, for comparison. */
#include "bench/bisect.h"

#include <math.h>

enum { DEPTH = 256 };

/* Intervals of time, and of both parameters. */
struct box {
    double lo[3], hi[3];
};

/* One coordinate of the difference of the two points at parameters p. */
static double differ(int kind, const double x0[4][3], const double x1[4][3],
                     int i, const double p[3])
{
    double x[4];
    for (int k = 0; k < 4; k++)
        x[k] = (1 - p[0]) * x0[k][i] + p[0] * x1[k][i];
    if (kind == 0)
        return x[0] - ((1 - p[1] - p[2]) * x[1] + p[1] * x[2] + p[2] * x[3]);
    return (1 - p[1]) * x[0] + p[1] * x[1] - ((1 - p[2]) * x[2] + p[2] * x[3]);
}

/* Whether the primitives may touch within the box. The difference of the two
 * points is linear in each parameter, so its values at the corners bound it;
 * 2^-46 of the largest coordinate covers the rounding of all 20 operations. */
static bool may_touch(int kind, const double x0[4][3], const double x1[4][3],
                      const struct box *b)
{
    if (kind == 0 && b->lo[1] + b->lo[2] > 1)
        return false;
    for (int i = 0; i < 3; i++) {
        double lo = INFINITY, hi = -INFINITY, size = 0;
        for (int k = 0; k < 4; k++)
            size = fmax(size, fmax(fabs(x0[k][i]), fabs(x1[k][i])));
        for (int c = 0; c < 8; c++) {
            double p[3];
            for (int k = 0; k < 3; k++)
                p[k] = c >> k & 1 ? b->hi[k] : b->lo[k];
            double d = differ(kind, x0, x1, i, p);
            lo = fmin(lo, d);
            hi = fmax(hi, d);
        }
        if (lo > 0x1p-46 * size || hi < -0x1p-46 * size)
            return false;
    }
    return true;
}

/* The search is depth first, the earlier half of time first. A box that begins
 * after the best time so far is dropped. */
bool bisect(int kind, const double x0[4][3], const double x1[4][3],
            double width, double *toi)
{
    struct box stack[DEPTH] = {{{0, 0, 0}, {1, 1, 1}}};
    int n = 1;
    double best = INFINITY;
    while (n > 0) {
        struct box b = stack[--n];
        if (b.lo[0] >= best || !may_touch(kind, x0, x1, &b))
            continue;
        int k = 0;
        for (int i = 1; i < 3; i++)
            k = b.hi[i] - b.lo[i] > b.hi[k] - b.lo[k] ? i : k;
        if (b.hi[k] - b.lo[k] <= width || n + 2 > DEPTH) {
            best = b.lo[0];
            continue;
        }
        double mid = (b.lo[k] + b.hi[k]) / 2;
        stack[n] = stack[n + 1] = b;
        stack[n++].lo[k] = mid;
        stack[n++].hi[k] = mid;
    }
    *toi = best;
    return best <= 1;
}
