/* SPDX-License-Identifier: Apache-2.0 */
/* Cuts a panel: in a corner of less than about 50 degrees the corner's own
 * particle may have no cell. Then another one takes its place.
 * app/patterns/README.md §6. */
#include "app/base/cut.h"

#include <math.h>
#include <string.h>

/* The cells that have the particle, in order; returns how many. */
static int cells_of(const struct cut *cut, int32_t p, int64_t cell[4])
{
    int count = 0;
    for (int k = 0; k < 4; k++) {
        int i = p % cut->m - k % 2, j = p / cut->m - k / 2;
        if (i < 0 || j < 0 || i >= cut->m - 1 || j >= cut->n - 1)
            continue;
        int64_t c = i + (int64_t)(cut->m - 1) * j;
        int32_t corner[4];
        bool has = false;
        for (int n = cut_corners(cut, c, corner) - 1; n >= 0; n--)
            has |= corner[n] == p;
        if (has)
            cell[count++] = c;
    }
    return count;
}

/* Divides the particle's cells anew. false: a triangle is too small. */
static bool divide(struct cut *cut, const struct border *border, int32_t p)
{
    int64_t cell[4];
    int count = cells_of(cut, p, cell);
    for (int k = 0; k < count; k++) {
        int32_t corner[4];
        uint8_t *kind = &cut->cell[cell[k]];
        int corners = cut_corners(cut, cell[k], corner);
        if (corners == 3 && !(cut_part(cut, corner) > CUT_LEAST))
            return false;
        uint8_t to = corners == 4 ? cut_divide(cut, border, corner) : *kind;
        if (to >= CUT_WITHOUT && corners == 4)
            return false;
        *kind = to;
    }
    return count > 0;
}

/* Moves a particle to where edge k begins, if its cells bear it. */
static bool move(struct cut *cut, const struct border *border, int32_t p, int k)
{
    const struct outline *outline = border->outline;
    int64_t cell[4];
    uint8_t before[4];
    double x[2];
    int count = cells_of(cut, p, cell);
    for (int c = 0; c < count; c++)
        before[c] = cut->cell[cell[c]];
    memcpy(x, cut->x[p], sizeof x);
    memcpy(cut->x[p], outline->x[outline->first[k]], sizeof x);
    if (divide(cut, border, p)) {
        cut->kind[p] = CUT_CORNER;
        cut->chord[p] = outline->first[k];
        cut->corner[k] = p;
        return true;
    }
    for (int c = 0; c < count; c++)
        cut->cell[cell[c]] = before[c];
    memcpy(cut->x[p], x, sizeof x);
    return false;
}

/* Whether a place is less than a cell from where the grid has a particle, as
 * drape_panel asks for. */
static bool may_be(const struct cut *cut, int32_t p, const double x[2])
{
    const int32_t at[2] = {p % cut->m, p / cut->m};
    const double less = 1 - 1e-6;
    bool near = true;
    for (int i = 0; i < 2; i++)
        near &= fabs(x[i] - cut->at[i] - at[i] * cut->h) < less * cut->h;
    return near;
}

/* Tries the particles near the corner, the nearest first, that lie on the two
 * edges which meet there: along them the border stays where it was. */
static void find(struct cut *cut, const struct border *border, int k)
{
    const struct outline *outline = border->outline;
    enum { REACH = 2, SIDE = 2 * REACH + 1 };
    const double *corner = outline->x[outline->first[k]];
    bool tried[SIDE * SIDE] = {false};
    int before = (k + outline->edges - 1) % outline->edges;
    int32_t at = cut->corner[k], best = at;
    while (best >= 0) {
        double least = 2 * cut->h;
        int slot = -1;
        best = -1;
        for (int q = 0; q < SIDE * SIDE; q++) {
            int i = at % cut->m + q % SIDE - REACH;
            int j = at / cut->m + q / SIDE - REACH;
            if (tried[q] || i < 0 || j < 0 || i >= cut->m || j >= cut->n)
                continue;
            int32_t p = i + cut->m * j;
            if (cut->kind[p] != CUT_BORDER || !may_be(cut, p, corner))
                continue;
            int edge = outline->of[cut->chord[p]];
            double d = plane_length(cut->x[p][0] - corner[0],
                                    cut->x[p][1] - corner[1]);
            if ((edge == k || edge == before) && d < least) {
                least = d;
                best = p;
                slot = q;
            }
        }
        if (best >= 0 && move(cut, border, best, k))
            return;
        if (best >= 0)
            tried[slot] = true;
    }
}

void cut_reach_corners(struct cut *cut, const struct border *border)
{
    for (int k = 0; k < border->outline->edges; k++)
        if (cut->kind[cut->corner[k]] == CUT_OUT)
            find(cut, border, k);
}
