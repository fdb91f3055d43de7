/* SPDX-License-Identifier: Apache-2.0 */
/* A strip that hangs by its upper end: strains along and across in its middle,
 * at rest. spec/validation.md §4 */
#include "validate/validate.h"

#include <math.h>
#include <stdlib.h>

static const double length = 0.3, wide = 0.1, weight = 0.3 * 9.81;

static double distance(const double a[3], const double b[3])
{
    return hypot(hypot(a[0] - b[0], a[1] - b[1]), a[2] - b[2]);
}

/* Young's modulus and Poisson's ratio of a strip cut along the warp. Halfway
 * between two rows the tension is the weight below, to the bit of the model. */
static bool warp(const struct validate *v, double h, double out[2])
{
    struct sheet s;
    int m = (int)(wide / h + 0.5) + 1, n = (int)(length / h + 0.5) + 1;
    sheet_make(v, &s, m, n, h);
    s.cloth.material.density = weight / 9.81;
    for (int i = 0; i < m; i++)
        sheet_pin(&s, i, 0);
    bool found = sheet_rest(&s, 1e-9);
    int j = n / 2, i = m / 2, d = m / 4;
    double load = weight * (length - j * h); /* mean of the rows j ± d */
    double along =
        distance(s.x[i + m * (j - d)], s.x[i + m * (j + d)]) / (2 * d * h) - 1;
    double across =
        distance(s.x[i - d + m * j], s.x[i + d + m * j]) / (2 * d * h) - 1;
    sheet_free(&s);
    out[0] = load / along;
    out[1] = -across / along;
    return found;
}

/* The same of a strip along the diagonal, whose borders are stairs: its width
 * is taken from the area of its cells, which is wrong by a part of a cell. */
static bool bias(const struct validate *v, double h, double out[2])
{
    struct sheet s;
    double step = h * sqrt(0.5); /* between rows across */
    int half = (int)(wide / 2 / step + 0.5), rows = (int)(length / step + 0.5);
    int first = half + 1, last = first + rows / 2 * 2;
    int side = (last + half) / 2 + 2;
    sheet_make(v, &s, side, side, h);
    s.cloth.material.density = weight / 9.81;
    /* gravity along the diagonal */
    s.def.gravity[0] = 9.81 * sqrt(0.5);
    s.def.gravity[1] = -9.81 * sqrt(0.5);
    int below = 0, middle = (first + last) / 4; /* of the diagonal's i */
    for (int p = 0; p < s.n; p++) {
        int i = p % side, j = p / side, row = i + j;
        s.hole[p] = abs(i - j) > half || row > last || row < first;
        if (!s.hole[p] && row <= first + 1)
            sheet_pin(&s, i, j);
    }
    for (int p = 0; p < s.n; p++) { /* cells whose middle is below the place */
        int i = p % side, j = p / side;
        bool cell = i + 1 < side && j + 1 < side && !s.hole[p] &&
                    !s.hole[p + 1] && !s.hole[p + side] &&
                    !s.hole[p + side + 1];
        below += cell ? i + j + 1 > 2 * middle    ? 2
                        : i + j + 1 == 2 * middle ? 1
                                                  : 0
                      : 0;
    }
    bool found = sheet_rest(&s, 1e-9);
    int d = half / 4 + 1, c = middle, at = side + 1;
    double rest = 2 * d * h * sqrt(2);
    double along = distance(s.x[(c - d) * at], s.x[(c + d) * at]) / rest - 1;
    double across =
        distance(s.x[c * at - d * (side - 1)], s.x[c * at + d * (side - 1)]) /
            rest -
        1;
    out[0] = weight * below / 2 * h * h / ((2 * half) * step) / along;
    out[1] = -across / along;
    sheet_free(&s);
    return found;
}

void part_tension(struct validate *v)
{
    static const double cell[SIZES] = {0.02, 0.01, 0.005, 0.0025};
    static const double due[] = {910, 0.3, 821.0526315789474,
                                 0.3684210526315789};
    static const char *const name[] = {
        "Young's modulus of a hanging strip in warp",
        "Poisson's ratio of a hanging strip in warp",
        "Young's modulus of a hanging strip in bias",
        "Poisson's ratio of a hanging strip in bias"};
    if (v->bits == 32) /* strains of 1e-4 are not in 24 bits */
        return;
    for (int k = 0; k < 4; k += 2) {
        struct property p[2];
        for (int q = 0; q < 2; q++)
            p[q] = (struct property){.part = "tension",
                                     .name = name[k + q],
                                     .unit = q ? "1" : "N/m",
                                     .theory = due[k + q],
                                     .bar = k ? v->quick ? 0.1 : 0.03 : 0.005,
                                     .share = true,
                                     .promised = true};
        for (int c = 0; c < (v->quick ? 2 : SIZES); c++) {
            double is[2];
            bool found = k ? bias(v, cell[c], is) : warp(v, cell[c], is);
            for (int q = 0; q < 2; q++)
                property_add(&p[q], cell[c], found ? is[q] : NAN);
        }
        property_end(v, &p[0]);
        property_end(v, &p[1]);
    }
}
