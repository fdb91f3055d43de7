/* SPDX-License-Identifier: Apache-2.0 */
/* Bounds the positions and the tangents of whole cloths.
 * spec/broad/extent.md */
#include "ref/broad/extent.h"

/* Reals that are reduced side by side: a multiple of 3, so that a lane always
 * holds one coordinate, and of the width of a processor's vector. Real k of a
 * row goes to lane k % LANES. */
enum { LANES = 24 };

struct lanes {
    real lo[LANES], hi[LANES];
    real nan[LANES]; /* 0, or NaN after a NaN or an infinity */
};

static void clear_lanes(struct lanes *l)
{
    for (int k = 0; k < LANES; k++) {
        l->lo[k] = R(INFINITY);
        l->hi[k] = -R(INFINITY);
        l->nan[k] = 0;
    }
}

static void join_row(struct lanes *restrict l, const real *restrict v)
{
    for (int k = 0; k < LANES; k++) {
        l->lo[k] = real_min(v[k], l->lo[k]);
        l->hi[k] = real_max(v[k], l->hi[k]);
    }
}

/* Joins the last n < LANES reals of a row, whole vecs. Free lanes repeat the
 * first vec: repeating a value changes neither minimum nor maximum. */
static void join_few(struct lanes *l, const real *v, int64_t n)
{
    real all[LANES];
    if (n < 3)
        return;
    for (int k = 0; k < LANES; k++)
        all[k] = v[k < n ? k : k % 3];
    join_row(l, all);
}

/* Joins the reals a[0 … n), and notes those that are not finite. */
static void note_reals(struct lanes *l, const real *a, int64_t n)
{
    for (; n >= LANES; n -= LANES, a += LANES) {
        join_row(l, a);
        for (int k = 0; k < LANES; k++)
            l->nan[k] += a[k] - a[k];
    }
    for (int k = 0; k < n; k++)
        l->nan[k] += a[k] - a[k];
    join_few(l, a, n);
}

/* Joins the n differences to - from. */
static void note_edges(struct lanes *l, const real *from, const real *to,
                       int64_t n)
{
    real d[LANES];
    for (; n >= LANES; n -= LANES, from += LANES, to += LANES) {
        for (int k = 0; k < LANES; k++)
            d[k] = to[k] - from[k];
        join_row(l, d);
    }
    for (int k = 0; k < n; k++)
        d[k] = to[k] - from[k];
    join_few(l, d, n);
}

/* Reduces the lanes to a box; a zero is written as +0. Returns false where a
 * position is NaN or out of range. */
static bool gather_lanes(const struct lanes *l, vec *lo, vec *hi)
{
    real a[3] = {R(INFINITY), R(INFINITY), R(INFINITY)}, b[3], nan = 0;
    for (int c = 0; c < 3; c++)
        b[c] = -a[c];
    for (int k = 0; k < LANES; k++) {
        a[k % 3] = real_min(l->lo[k], a[k % 3]);
        b[k % 3] = real_max(l->hi[k], b[k % 3]);
        nan += l->nan[k];
    }
    *lo = vec_make(a[0] + 0, a[1] + 0, a[2] + 0);
    *hi = vec_make(b[0] + 0, b[1] + 0, b[2] + 0);
    return nan == 0 && vec_sane(*lo) && vec_sane(*hi);
}

/* §1: bounds one grid at both ends of the step. Returns false where a position
 * is NaN or out of range. */
static bool measure_grid(const struct extent *s, const struct tree_grid *g,
                         struct mesh_bounds *w)
{
    struct lanes end[2], u, v;
    int64_t row = 3 * (int64_t)g->m;
    clear_lanes(&end[0]);
    clear_lanes(&end[1]);
    clear_lanes(&u);
    clear_lanes(&v);
    for (int64_t j = 0; j < g->n; j++)
        for (int k = 0; k < 2; k++) {
            const real *a = &(k ? s->x1 : s->x0)[g->base + j * g->m].x;
            note_reals(&end[k], a, row);
            note_edges(&u, a, a + 3, row - 3);
            if (j + 1 < g->n)
                note_edges(&v, a, a + row, row);
        }
    gather_lanes(&u, &w->tangents.ulo, &w->tangents.uhi);
    gather_lanes(&v, &w->tangents.vlo, &w->tangents.vhi);
    bool good = gather_lanes(&end[0], &w->box.lo0, &w->box.hi0);
    return gather_lanes(&end[1], &w->box.lo1, &w->box.hi1) && good;
}

int ref_extent(struct extent *s)
{
    bool good = true;
    for (int64_t k = 0; k < s->n_grid; k++)
        good &= measure_grid(s, &s->grid[k], &s->bounds[k]);
    return good ? DRAPE_OK : DRAPE_EDATA;
}
