/* SPDX-License-Identifier: Apache-2.0 */
/* Lateral buckling of a strip that is held on edge. spec/validation.md §10 */
#include "ci/validate/validate.h"

#include <math.h>

static const double stiffness = 1e-4, weight = 0.2 * 9.81;

/* How far the free end of a strip that stands on edge moves sideways, over its
 * length, where gravity pulls a thousandth sideways too. `across` cells of
 * width, twenty times as many of length; two columns are pinned, so the clamp
 * is half a cell before the second of them. */
static double lean(const struct validate *v, double gamma, int across)
{
    struct sheet s;
    double length = cbrt(gamma * stiffness / weight);
    int along = 20 * across;
    double h = length / (along - 0.5);
    sheet_make(v, &s, along + 1, across + 1, h);
    s.cloth.material.bend = stiffness;
    s.def.gravity[2] = 1e-3 * s.def.gravity[1];
    for (int j = 0; j <= across; j++) {
        sheet_pin(&s, 0, j);
        sheet_pin(&s, 1, j);
    }
    bool found = sheet_rest(&s, (v->bits == 64 ? 1e-8 : 1e-5) * length);
    double side = s.x[along + (along + 1) * (across / 2)][2] / length;
    sheet_free(&s);
    return found ? side : NAN;
}

/* The critical Γ by Southwell's method: a small lean grows as Γ / (1 − Γ²/Γc²),
 * here between two Γ below it. */
static double critical(const struct validate *v, int across)
{
    const double a = 10, b = 12;
    double f = lean(v, a, across) / a / (lean(v, b, across) / b);
    return sqrt((b * b - f * a * a) / (1 - f));
}

void part_buckling(struct validate *v)
{
    static const int across[SIZES] = {4, 6, 8, 12};
    const double third = 1.0 / 3; /* Poisson's ratio for bending */
    struct property p = {.part = "buckling",
                         .name = "critical Γ of a strip on edge",
                         .unit = "1",
                         .bar = 0.05,
                         .share = true};
    /* Michell 1899, Prandtl 1899: w W L³ = 12.85 √(B C), with B = D (1 − ν²) W
     * the stiffness of bending sideways and C = 2 D (1 − ν) W that of twist. */
    p.theory = 12.85 * sqrt((1 - third * third) * 2 * (1 - third));
    if (v->quick || v->bits == 32)
        return;
    for (int k = 0; k < SIZES; k++)
        property_add(&p, cbrt(12 * stiffness / weight) / (20 * across[k]),
                     critical(v, across[k]));
    property_end(v, &p);
}
