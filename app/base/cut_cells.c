/* SPDX-License-Identifier: Apache-2.0 */
/* Cuts a panel: which cells are there, whole or as triangles.
 * app/patterns/README.md §5. */
#include "app/base/cut.h"

#include <math.h>
#include <stdlib.h>

/* Chords by the rows of the grid that they meet. */
struct rows {
    const struct outline *outline;
    double at, h;
    int count;
    int64_t *first;
    int32_t *chord;
};

static int row_of(const struct rows *rows, double y)
{
    double k = floor((y - rows->at) / rows->h);
    if (!(k > 0))
        return 0;
    return k < rows->count - 1 ? (int)k : rows->count - 1;
}

/* Counts the chords of each row, or, where chord is there, puts them. */
static void sort_in(struct rows *rows)
{
    const struct outline *o = rows->outline;
    for (int32_t c = 0; c < o->n; c++) {
        int a = row_of(rows, o->x[c][1]), b = row_of(rows, o->x[c + 1][1]);
        for (int k = a < b ? a : b; k <= a || k <= b; k++) {
            if (rows->chord)
                rows->chord[--rows->first[k]] = c;
            else
                rows->first[k]++;
        }
    }
}

static bool make_rows(struct rows *rows, const struct cut *cut,
                      const struct outline *outline)
{
    *rows = (struct rows){outline, cut->at[1], cut->h, cut->n, NULL, NULL};
    rows->first = calloc((size_t)cut->n + 1, sizeof *rows->first);
    if (!rows->first)
        return false;
    sort_in(rows);
    for (int k = 1; k <= rows->count; k++)
        rows->first[k] += rows->first[k - 1];
    rows->chord =
        malloc(((size_t)rows->first[rows->count] + 1) * sizeof *rows->chord);
    if (rows->chord)
        sort_in(rows);
    else
        free(rows->first);
    return rows->chord;
}

/* Whether the point is inside the outline: a ray to its right crosses the
 * outline an odd number of times. */
static bool is_inside(const struct rows *rows, const double x[2])
{
    int row = row_of(rows, x[1]);
    bool inside = false;
    for (int64_t k = rows->first[row]; k < rows->first[row + 1]; k++) {
        const double *a = rows->outline->x[rows->chord[k]], *b = a + 2;
        inside ^= segment_meets_ray(x, a, b);
    }
    return inside;
}

double cut_part(const struct cut *cut, const int32_t p[3])
{
    const double *x = cut->x[p[0]], *y = cut->x[p[1]], *z = cut->x[p[2]];
    return ((y[0] - x[0]) * (z[1] - x[1]) - (y[1] - x[1]) * (z[0] - x[0])) /
           (2 * cut->h * cut->h);
}

/* Whether the way from x to y crosses the outline. A thousandth is left out at
 * its ends, which may lie on the outline. */
static bool is_cut(const struct border *border, const double x[2],
                   const double y[2])
{
    static const double end = 0.001;
    const struct buckets *by = &border->chords;
    double from[2], to[2];
    for (int i = 0; i < 2; i++) {
        from[i] = x[i] + end * (y[i] - x[i]);
        to[i] = y[i] + end * (x[i] - y[i]);
    }
    int lo[2], hi[2];
    for (int i = 0; i < 2; i++) {
        lo[i] = bucket_of(by, i, fmin(from[i], to[i]));
        hi[i] = bucket_of(by, i, fmax(from[i], to[i]));
    }
    for (int j = lo[1]; j <= hi[1]; j++)
        for (int i = lo[0]; i <= hi[0]; i++) {
            int64_t q = i + (int64_t)by->m * j;
            for (int64_t f = by->first[q]; f < by->first[q + 1]; f++) {
                const double *a = border->outline->x[by->item[f]];
                if (segments_meet(from, to, a, a + 2))
                    return true;
            }
        }
    return false;
}

/* Whether the way from particle p to q leaves the panel: it crosses the
 * outline, or bridges a gap between two parts of it that face each other. */
static bool is_bridge(const struct cut *cut, const struct border *border,
                      int32_t p, int32_t q)
{
    const struct outline *o = border->outline;
    int32_t c = cut->chord[p], d = cut->chord[q];
    if (c < 0 && d < 0)
        return false;
    if (c < 0 || d < 0)
        return is_cut(border, cut->x[p], cut->x[q]);
    const double *a = o->x[c], *b = o->x[c + 1];
    const double *e = o->x[d], *f = o->x[d + 1];
    return (b[0] - a[0]) * (f[0] - e[0]) + (b[1] - a[1]) * (f[1] - e[1]) < 0 &&
           outline_is_right(o, c, cut->x[q]) &&
           outline_is_right(o, d, cut->x[p]);
}

/* The triangle that is left of a cell without its corner k; 0 if it bridges a
 * gap. */
static double part_without(const struct cut *cut, const struct border *border,
                           const int32_t p[4], int k)
{
    const int32_t left[3] = {p[(k + 1) % 4], p[(k + 2) % 4], p[(k + 3) % 4]};
    for (int i = 0; i < 3; i++)
        if (is_bridge(cut, border, left[i], left[(i + 1) % 3]))
            return 0;
    return cut_part(cut, left);
}

uint8_t cut_divide(const struct cut *cut, const struct border *border,
                   const int32_t p[4])
{
    double without[4], most = CUT_LEAST;
    for (int k = 0; k < 4; k++)
        without[k] = part_without(cut, border, p, k);
    double rising = fmin(without[3], without[1]);
    double falling = fmin(without[0], without[2]);
    if (fmax(rising, falling) >= CUT_LEAST)
        return rising >= falling ? CUT_RISING : CUT_FALLING;
    int best = -1;
    for (int k = 0; k < 4; k++) {
        if (cut->kind[p[k]] == CUT_IN || !(without[k] > most))
            continue;
        best = k;
        most = without[k];
    }
    return best < 0 ? CUT_ABSENT : (uint8_t)(CUT_WITHOUT + best);
}

/* Whether a particle is where the grid has it. */
static bool is_still(const struct cut *cut, int32_t p)
{
    return cut->x[p][0] == cut->at[0] + cut->h * (double)(p % cut->m) &&
           cut->x[p][1] == cut->at[1] + cut->h * (double)(p / cut->m);
}

/* Whether the mean of a cell's corners is inside. */
static bool is_cell_inside(const struct cut *cut, const struct rows *rows,
                           const int32_t p[4], uint8_t kind)
{
    double middle[2] = {0, 0}, count = kind >= CUT_WITHOUT ? 3 : 4;
    for (int k = 0; k < 4; k++)
        for (int i = 0; i < 2 && kind != CUT_WITHOUT + k; i++)
            middle[i] += cut->x[p[k]][i] / count;
    return is_inside(rows, middle);
}

static uint8_t choose(const struct cut *cut, const struct border *border,
                      const struct rows *rows, const int32_t p[4])
{
    int there = 0, still = 0, inside = 0, lost = 0;
    for (int k = 0; k < 4; k++) {
        if (cut->kind[p[k]] == CUT_OUT) {
            lost = k;
            continue;
        }
        there++;
        still += is_still(cut, p[k]);
        inside += cut->kind[p[k]] == CUT_IN;
    }
    if (there < 3)
        return CUT_ABSENT;
    if (inside == 4)
        return CUT_REGULAR;
    uint8_t kind = CUT_ABSENT;
    if (there == 4)
        kind = cut_divide(cut, border, p);
    else if (part_without(cut, border, p, lost) > CUT_LEAST)
        kind = (uint8_t)(CUT_WITHOUT + lost);
    if (kind == CUT_ABSENT || !is_cell_inside(cut, rows, p, kind))
        return CUT_ABSENT;
    return still == 4 && kind == CUT_RISING ? CUT_REGULAR : kind;
}

bool cut_choose(struct cut *cut, const struct border *border)
{
    struct rows rows;
    if (!make_rows(&rows, cut, border->outline))
        return false;
    int64_t cell = 0;
    for (int32_t j = 0; j + 1 < cut->n; j++)
        for (int32_t i = 0; i + 1 < cut->m; i++) {
            int32_t a = i + cut->m * j;
            const int32_t p[4] = {a, a + 1, a + 1 + cut->m, a + cut->m};
            cut->cell[cell++] = choose(cut, border, &rows, p);
        }
    free(rows.first);
    free(rows.chord);
    return true;
}
