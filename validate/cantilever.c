/* SPDX-License-Identifier: Apache-2.0 */
/* The heavy cantilever of Romero et al. 2021. spec/validation.md §2 */
#include "validate/validate.h"

#include <math.h>
#include <stdlib.h>

static const double stiffness = 1e-4, weight = 0.2 * 9.81;

/* Drop over distance of the tip of a strip of `cells` cells of length and
 * n particles of width: two rows are pinned, so the clamp is half a cell before
 * the second of them (cloth.md §7). Measured in the middle of the width. */
static double warp(const struct validate *v, double gamma, int cells, int n)
{
    struct sheet s;
    double length = cbrt(gamma * stiffness / weight);
    double h = length / (cells - 0.5);
    sheet_make(v, &s, cells + 1, n, h);
    s.cloth.material.bend = stiffness;
    sheet_lay(&s);
    for (int j = 0; j < n; j++) {
        sheet_pin(&s, 0, j);
        sheet_pin(&s, 1, j);
    }
    bool found = sheet_rest(&s, (v->bits == 64 ? 1e-7 : 1e-5) * length);
    const double *tip = s.x[cells + (cells + 1) * (n / 2)];
    double ratio = -tip[1] / (tip[0] - h / 2);
    sheet_free(&s);
    return found ? ratio : NAN;
}

/* The same of a strip along the diagonal of the cells, as wide as it is long,
 * whose borders are stairs. `last` is the number of the row across of the tip
 * and `first` that of the last one that is pinned, h/√2 apart. Triples along
 * the diagonal, two thirds of the moment, reach over two rows and those along
 * the axes over one: the deflection of a line of both with a load at its end is
 * that of a beam clamped 0.828 rows before `first`. The plane's stiffness keeps
 * the strip from bending across as well. It is less for strips that curve more,
 * as a curved grid locks: spec/validation.md §2. */
static double bias(const struct validate *v, double gamma, int cells)
{
    const double before = 0.828;
    struct sheet s;
    double length = cbrt(gamma * stiffness / weight);
    int rows = 2 * (int)(cells * sqrt(0.5) + 0.5), wide = rows / 2;
    int first = wide + 4, last = first + rows;
    last += last % 2;
    double h = sqrt(2) * length / (last - first + before);
    int side = (last + wide) / 2 + 1;
    sheet_make(v, &s, side, side, h);
    s.cloth.material.bend = stiffness;
    s.cloth.material.stretch = 1e5 / gamma;
    s.cloth.material.shear = 3e4 / gamma;
    sheet_lay(&s);
    for (int p = 0; p < s.n; p++) {
        int i = p % side, j = p / side, row = i + j;
        s.hole[p] = abs(i - j) > wide || row > last || row < first - 4;
        if (!s.hole[p] && row <= first && row >= first - 2)
            sheet_pin(&s, i, j);
    }
    bool found = sheet_rest(&s, (v->bits == 64 ? 1e-7 : 1e-5) * length);
    const double *tip = s.x[last / 2 * (side + 1)];
    double along = (tip[0] - tip[2]) * sqrt(0.5);
    double ratio = -tip[1] / (along - (first - before) * h * sqrt(0.5));
    sheet_free(&s);
    return found ? ratio : NAN;
}

static void row(struct validate *v, double gamma, const char *kind, double bar)
{
    static const int cells[2][SIZES] = {{12, 25, 50, 100}, {16, 25, 36, 50}};
    char name[96];
    snprintf(name, sizeof name, "%s; Γ = %g", kind, gamma);
    struct property p = {.part = "cantilever",
                         .name = name,
                         .unit = "H/W",
                         .theory = elastica(gamma),
                         .bar = bar,
                         .share = true,
                         .promised = true};
    double length = cbrt(gamma * stiffness / weight);
    bool ribbon = kind[0] == 'r', sheet = kind[0] == 's';
    p.up_to = length / 50;
    int sizes = v->quick ? 2 : sheet ? SIZES - 1 : SIZES;
    for (int c = 0; c < sizes; c++) {
        int n = cells[!ribbon][c];
        property_add(&p, length / n,
                     ribbon  ? warp(v, gamma, n, 2)
                     : sheet ? warp(v, gamma, n, 4 * n + 1)
                             : bias(v, gamma, n));
    }
    property_end(v, &p);
}

void part_cantilever(struct validate *v)
{
    static const double gamma[] = {1, 3, 10, 30, 100};
    for (int k = 0; k < 5; k++)
        row(v, gamma[k], "ribbon in warp", 0.01);
    for (int k = v->quick ? 2 : 0; k < (v->quick ? 3 : 5); k += 2)
        row(v, gamma[k], "bias strip", v->quick ? 0.08 : 0.03);
    for (int k = 0; k < 5 && !v->quick && v->bits == 64; k += 4)
        row(v, gamma[k], "sheet in warp", 0.01);
}
