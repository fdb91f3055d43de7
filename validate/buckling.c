/* SPDX-License-Identifier: Apache-2.0 */
/* A slender strip that is rolled about its axis: lateral buckling where it
 * stands on edge, and bending with twist. spec/validation.md §10, §11 */
#include "validate/ribbon.h"

#include <math.h>

/* Cells of width. */
static const int across[SIZES] = {2, 3, 4, 6};

/* The critical Γ by Southwell's method: a small lean grows as Γ / (1 − Γ²/Γc²),
 * here between two Γ below it. `cells` of width, or 0: of the rod. */
static double critical(const struct validate *v, int cells)
{
    static const double gamma[2] = {8, 10};
    double lean[2];
    for (int k = 0; k < 2; k++) {
        double tip[2];
        /* From the upright by a thousandth. */
        struct ribbon r = {gamma[k], acos(-1) / 2 - 1e-3};
        if (cells)
            ribbon_sheet(v, &r, cells, tip);
        else
            ribbon_rod(&r, tip);
        lean[k] = tip[1] / gamma[k];
    }
    double a = gamma[0], b = gamma[1], f = lean[0] / lean[1];
    return sqrt((b * b - f * a * a) / (1 - f));
}

void part_buckling(struct validate *v)
{
    if (v->bits == 32)
        return;
    struct property p = {.part = "buckling",
                         .name = "critical Γ of a strip on edge",
                         .unit = "1",
                         .theory = critical(v, 0),
                         .bar = v->quick ? 0.25 : 0.05,
                         .share = true,
                         .promised = true};
    for (int k = 0; k < (v->quick ? 2 : SIZES); k++) {
        struct ribbon r = {10, 0};
        property_add(&p, ribbon_length(&r) / (20 * across[k]),
                     critical(v, across[k]));
    }
    property_end(v, &p);
}

void part_bendtwist(struct validate *v)
{
    static const double degrees[] = {30, 60};
    static const char *const what[] = {"drop", "way to the side"};
    if (v->bits == 32)
        return;
    for (int d = 0; d < (v->quick ? 1 : 2); d++) {
        struct ribbon r = {5, degrees[d] * acos(-1) / 180};
        struct property p[2];
        char name[2][96];
        double due[2], tip[2];
        ribbon_rod(&r, due);
        for (int q = 0; q < 2; q++) {
            snprintf(name[q], sizeof name[q],
                     "strip rolled by %g degrees; Γ = %g; %s of the tip",
                     degrees[d], r.gamma, what[q]);
            p[q] = (struct property){.part = "bendtwist",
                                     .name = name[q],
                                     .unit = "of L",
                                     .theory = due[q],
                                     .bar = v->quick ? 0.1 : 0.05,
                                     .share = true,
                                     .promised = d == 0};
        }
        for (int k = 0; k < (v->quick ? 2 : SIZES); k++) {
            ribbon_sheet(v, &r, across[k], tip);
            for (int q = 0; q < 2; q++)
                property_add(&p[q], ribbon_length(&r) / (20 * across[k]),
                             tip[q]);
        }
        for (int q = 0; q < 2; q++)
            property_end(v, &p[q]);
    }
}
