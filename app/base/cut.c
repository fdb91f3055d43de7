/* SPDX-License-Identifier: Apache-2.0 */
/* Cuts a panel: its cells, and the order of the steps. */
#include "app/base/cut.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The particle that is corner k of a cell. */
static int32_t corner_of(const struct cut *cut, int64_t cell, int k)
{
    int64_t i = cell % (cut->m - 1), j = cell / (cut->m - 1);
    return (int32_t)(i + (k == 1 || k == 2) + cut->m * (j + (k >= 2)));
}

int cut_corners(const struct cut *cut, int64_t cell, int32_t corner[4])
{
    int count = 0;
    for (int k = 0; k < 4; k++)
        if (cut_has(cut->cell[cell], k))
            corner[count++] = corner_of(cut, cell, k);
    return count;
}

int cut_triangles(const struct cut *cut, int64_t cell, int32_t tri[2][3])
{
    int32_t p[4];
    int count = cut_corners(cut, cell, p);
    int from = cut->cell[cell] == CUT_FALLING;
    for (int k = 0; k + 2 < count; k++) {
        tri[k][0] = p[from];
        tri[k][1] = p[(from + k + 1) % count];
        tri[k][2] = p[(from + k + 2) % count];
    }
    return count ? count - 2 : 0;
}

bool cut_is_border(const struct cut *cut, int64_t cell, int k, int count)
{
    int lost = cut->cell[cell] - CUT_WITHOUT;
    int m = cut->m - 1, n = cut->n - 1;
    int i = (int)(cell % m), j = (int)(cell / m);
    if (count == 3) {
        /* of a triangle, edge k is the diagonal or a side of the cell */
        int a = k < lost ? k : k + 1, b = (k + 1) % 3;
        b = b < lost ? b : b + 1;
        if ((b - a + 4) % 4 == 2)
            return true;
        k = a;
    }
    /* across side k: below, right, above, left */
    i += k == 1 ? 1 : k == 3 ? -1 : 0;
    j += k == 2 ? 1 : k == 0 ? -1 : 0;
    if (i < 0 || j < 0 || i >= m || j >= n)
        return true;
    uint8_t other = cut->cell[i + (int64_t)m * j];
    return !cut_has(other, (k + 2) % 4) || !cut_has(other, (k + 3) % 4);
}

static void count(struct cut *cut)
{
    int64_t cells = (int64_t)(cut->m - 1) * (cut->n - 1);
    int64_t all = (int64_t)cut->m * cut->n;
    cut->regular = cut->moved = cut->triangles = 0;
    for (int64_t c = 0; c < cells; c++) {
        cut->regular += cut->cell[c] == CUT_REGULAR;
        cut->moved += cut->cell[c] == CUT_RISING || cut->cell[c] == CUT_FALLING;
        cut->triangles += cut->cell[c] >= CUT_WITHOUT;
    }
    cut->absent = cells - cut->regular - cut->moved - cut->triangles;
    cut->particles = cut->borders = 0;
    for (int64_t p = 0; p < all; p++) {
        cut->particles += cut->kind[p] != CUT_OUT;
        cut->borders += cut->kind[p] >= CUT_BORDER;
    }
}

static bool take_room(struct cut *cut, const struct outline *outline)
{
    size_t all = (size_t)cut->m * (size_t)cut->n;
    size_t cells = (size_t)(cut->m - 1) * (size_t)(cut->n - 1);
    cut->x = malloc(all * sizeof *cut->x);
    cut->kind = calloc(all, sizeof *cut->kind);
    cut->chord = malloc(all * sizeof *cut->chord);
    cut->cell = calloc(cells, sizeof *cut->cell);
    cut->corner = malloc((size_t)outline->edges * sizeof *cut->corner);
    return cut->x && cut->kind && cut->chord && cut->cell && cut->corner;
}

/* The steps after the particles are there. */
static enum cut_status cut_by(struct cut *cut, const struct border *border,
                              double x[2])
{
    cut_snap(cut, border->outline);
    if (!cut_choose(cut, border))
        return CUT_MEMORY;
    enum cut_status status = cut_join(cut, x);
    if (status != CUT_OK)
        return status;
    cut_reach_corners(cut, border);
    count(cut);
    return cut_measure(cut, border) ? CUT_OK : CUT_MEMORY;
}

enum cut_status cut_make(struct cut *cut, const struct outline *outline,
                         double h, double x[2])
{
    *cut = (struct cut){.h = h, .at = {outline->lo[0], outline->lo[1]}};
    struct border border = {.outline = outline};
    double size[2];
    /* a line of the grid that is further than h / 2 from the outline has no
     * particle */
    for (int i = 0; i < 2; i++)
        size[i] = 1 + floor((outline->hi[i] - outline->lo[i]) / h + 0.5 + 1e-9);
    if (!(size[0] * size[1] <= CUT_MOST))
        return CUT_LARGE;
    if (size[0] < 2 || size[1] < 2)
        return CUT_NONE;
    cut->m = (int)size[0];
    cut->n = (int)size[1];
    if (!take_room(cut, outline) ||
        !buckets_make(&border.chords, (const double(*)[2])outline->x, NULL,
                      outline->n, h))
        return CUT_MEMORY;
    enum cut_status status = cut_by(cut, &border, x);
    buckets_free(&border.chords);
    return status;
}

void cut_free(struct cut *cut)
{
    free(cut->x);
    free(cut->kind);
    free(cut->chord);
    free(cut->cell);
    free(cut->corner);
    memset(cut, 0, sizeof *cut);
}
