/* SPDX-License-Identifier: Apache-2.0 */
#include "validate/shadow.h"

#include <math.h>
#include <stdlib.h>

enum { SIDE = 1280 }; /* pixels of a quarter of a millimetre */
static const double pixel = 0.25e-3;

/* Marks the pixels whose middles lie in the triangle. */
static void fill(uint8_t *map, const double a[3], const double b[3],
                 const double c[3])
{
    const double *corner[3] = {a, b, c};
    double x[3], z[3];
    for (int k = 0; k < 3; k++) {
        x[k] = corner[k][0] / pixel + SIDE / 2 - 0.5;
        z[k] = corner[k][2] / pixel + SIDE / 2 - 0.5;
    }
    double top = fmin(z[0], fmin(z[1], z[2])),
           end = fmax(z[0], fmax(z[1], z[2]));
    for (int row = (int)ceil(fmax(top, 0)); row <= end && row < SIDE; row++) {
        double lo = INFINITY, hi = -INFINITY;
        for (int k = 0; k < 3; k++) {
            int l = (k + 1) % 3;
            if ((z[k] < row) == (z[l] < row) && z[k] != row)
                continue;
            double t = z[l] == z[k] ? 0 : (row - z[k]) / (z[l] - z[k]);
            if (t < 0 || t > 1)
                continue;
            double at = x[k] + t * (x[l] - x[k]);
            lo = fmin(lo, at);
            hi = fmax(hi, at);
        }
        for (int at = (int)ceil(fmax(lo, 0)); at <= hi && at < SIDE; at++)
            map[at + SIDE * row] = 1;
    }
}

/* Folds of the outline: how often its radius rises through the mean, by more
 * than a hundredth of it. */
static int folds(const uint8_t *map)
{
    enum { BINS = 360 };
    double radius[BINS] = {0}, mean = 0;
    for (int p = 0; p < SIDE * SIDE; p++) {
        double x = p % SIDE - SIDE / 2 + 0.5, z = p / SIDE - SIDE / 2 + 0.5;
        int bin = (int)(BINS * (atan2(z, x) / (2 * acos(-1)) + 0.5));
        bin = bin < BINS ? bin : BINS - 1;
        if (map[p])
            radius[bin] = fmax(radius[bin], hypot(x, z));
    }
    for (int k = 0; k < BINS; k++)
        mean += radius[k] / BINS;
    int count = 0, above = 0; /* 0: not known yet */
    for (int k = 0; k < 2 * BINS; k++) {
        double off = radius[k % BINS] / mean - 1;
        int now = off > 0.01 ? 1 : off < -0.01 ? -1 : above;
        count += k >= BINS && above < 0 && now > 0;
        above = now;
    }
    return count;
}

struct shadow shadow_of(const struct sheet *s)
{
    struct shadow shadow = {0, 0};
    uint8_t *map = take((size_t)SIDE * SIDE, 1);
    int m = s->cloth.m;
    for (int64_t p = 0; p + m + 1 < s->n; p++) {
        bool cell = p % m + 1 < m && !s->hole[p] && !s->hole[p + 1] &&
                    !s->hole[p + m] && !s->hole[p + m + 1];
        if (!cell)
            continue;
        fill(map, s->x[p], s->x[p + 1], s->x[p + m + 1]);
        fill(map, s->x[p], s->x[p + m + 1], s->x[p + m]);
    }
    for (int p = 0; p < SIDE * SIDE; p++)
        shadow.area += map[p] * pixel * pixel;
    shadow.folds = folds(map);
    free(map);
    return shadow;
}
