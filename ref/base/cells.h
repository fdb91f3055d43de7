/* SPDX-License-Identifier: Apache-2.0 */
/* The cells of a definition's grid: what they are, their corners and their
 * triangles. spec/cloth/cloth.md §1, §3; spec/panel/panel.md §1 */
#ifndef REF_CELLS_H
#define REF_CELLS_H

#include "ref/base/stage.h"

/* The kind of cell (i, j), enum drape_cell. Without a panel a cell is regular
 * iff it is not cut and no corner of it is a hole. */
static inline int cell_kind(const drape_cloth *d, int64_t i, int64_t j)
{
    if (i < 0 || j < 0 || i >= d->m - 1 || j >= d->n - 1)
        return DRAPE_CELL_ABSENT;
    int64_t p = i + d->m * j, cell = i + (d->m - 1) * j;
    if (d->panel)
        return d->panel->cell[cell];
    if (d->cut && d->cut[cell])
        return DRAPE_CELL_ABSENT;
    bool hole = d->hole && (d->hole[p] || d->hole[p + 1] || d->hole[p + d->m] ||
                            d->hole[p + d->m + 1]);
    return hole ? DRAPE_CELL_ABSENT : DRAPE_CELL_REGULAR;
}

/* Whether a cell is there and not regular. */
static inline bool cell_is_odd(int kind)
{
    return kind > DRAPE_CELL_REGULAR;
}

/* The corners of a cell whose corner 0 is p: 4, 3 or, where it is absent, 0;
 * counter-clockwise, of a triangle from the one behind the missing one. */
static inline int cell_corners(int kind, int64_t p, int32_t m, int64_t at[4])
{
    const int64_t all[4] = {p, p + 1, p + m + 1, p + m};
    int count = kind == DRAPE_CELL_ABSENT   ? 0
                : kind < DRAPE_CELL_WITHOUT ? 4
                                            : 3;
    int first = count == 3 ? kind - DRAPE_CELL_WITHOUT + 1 : 0;
    for (int k = 0; k < count; k++)
        at[k] = all[(first + k) % 4];
    return count;
}

/* The triangles of a cell: 2, 1 or, where it is absent, 0. */
static inline int cell_triangles(int kind, int64_t p, int32_t m,
                                 int64_t tri[2][3])
{
    int64_t at[4];
    int count = cell_corners(kind, p, m, at);
    int end = kind == DRAPE_CELL_FALLING ? 3 : 2;
    for (int t = 0; t < count - 2; t++) {
        tri[t][0] = at[t ? end - 2 : 0];
        tri[t][1] = at[t ? 2 : 1];
        tri[t][2] = at[t ? 3 : end];
    }
    return count > 2 ? count - 2 : 0;
}

#endif
