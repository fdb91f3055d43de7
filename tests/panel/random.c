/* SPDX-License-Identifier: Apache-2.0 */
/* Random panels. tests/panel/random.h */
#include "tests/panel/random.h"

#include "ref/base/cells.h"

/* The smallest triangle of a cell, as a part of the area of a regular one. */
static double least_part(const drape_cloth *c, int kind, int64_t p)
{
    int64_t tri[2][3];
    double cell = c->width / (c->m - 1) * (c->height / (c->n - 1)), least = 1;
    int n = cell_triangles(kind, p, c->m, tri);
    for (int t = 0; t < n; t++) {
        const double *x = c->panel->rest[tri[t][0]];
        const double *y = c->panel->rest[tri[t][1]];
        const double *z = c->panel->rest[tri[t][2]];
        double area = 0.5 * ((y[0] - x[0]) * (z[1] - x[1]) -
                             (y[1] - x[1]) * (z[0] - x[0]));
        least = fmin(least, area / cell);
    }
    return least;
}

/* Draws what a cell is, until its triangles are large enough. */
static uint8_t pick_kind(struct bytes *b, const drape_cloth *c, int64_t p,
                         bool moved)
{
    for (int tries = 0; tries < 8; tries++) {
        int kind = moved || !pick(b, 6) ? (int)pick(b, DRAPE_CELL_WITHOUT + 4)
                                        : DRAPE_CELL_REGULAR;
        if (!(moved && kind == DRAPE_CELL_REGULAR) &&
            least_part(c, kind, p) >= 0.06)
            return (uint8_t)kind;
    }
    return DRAPE_CELL_ABSENT;
}

void random_panel(struct bytes *b, drape_cloth *c, struct random_panel *s)
{
    double side[2] = {c->width / (c->m - 1), c->height / (c->n - 1)};
    uint32_t each = 1 + pick(b, 12);
    bool moved[RANDOM_SIDE * RANDOM_SIDE] = {false};
    s->panel.rest = (const double(*)[2])s->rest;
    s->panel.cell = s->cell;
    c->panel = &s->panel;
    c->hole = c->cut = NULL;
    for (int p = 0; p < c->m * c->n; p++) {
        moved[p] = !pick(b, each);
        for (int k = 0; k < 2; k++) {
            double off =
                moved[p] ? (double)pick_uniform(b, R(-0.4), R(0.4)) : 0;
            s->rest[p][k] = side[k] * ((k ? p / c->m : p % c->m) + off);
        }
    }
    for (int j = 0; j < c->n - 1; j++)
        for (int i = 0; i < c->m - 1; i++) {
            int p = i + c->m * j;
            bool any = moved[p] || moved[p + 1] || moved[p + c->m] ||
                       moved[p + c->m + 1];
            s->cell[i + (c->m - 1) * j] = pick_kind(b, c, p, any);
        }
}
