/* SPDX-License-Identifier: Apache-2.0 */
/* Sparse matrix times vector (SpMV) by differences. spec/solve/product.md */
#include "ref/solve/product.h"

/* §3: rows of the grid that one thread owns. A spring with both ends in these
 * rows is computed once. */
enum { BAND = 16 };

/* The blocks of one direction that start in one row of the grid. packed: read
 * in place of block, unless NULL. */
struct edges {
    const sym *block;
    const struct packed_parts *packed;
};

/* §1: B (x_p - x_q) for particle p = i of the row, q = p + step. */
static inline vec pull_of(struct edges b, int32_t i, const vec *x, int64_t step)
{
    vec d = vec_sub(x[i], x[i + step]);
    return b.packed ? packed_apply(b.packed[i], d) : sym_apply(b.block[i], d);
}

/* Adds each spring's term to both of its ends. As i ascends, a particle
 * receives the spring that ends at it before the spring that starts at it; §1
 * demands this order. */
static void pull_both(int32_t n, struct edges b, const vec *restrict x,
                      int64_t step, vec *restrict y)
{
    for (int32_t i = 0; i < n; i++) {
        vec f = pull_of(b, i, x, step);
        y[i] = vec_add(y[i], f);
        y[i + step] = vec_sub(y[i + step], f);
    }
}

static void pull_first(int32_t n, struct edges b, const vec *restrict x,
                       int64_t step, vec *restrict y)
{
    for (int32_t i = 0; i < n; i++)
        y[i] = vec_add(y[i], pull_of(b, i, x, step));
}

static void pull_second(int32_t n, struct edges b, const vec *restrict x,
                        int64_t step, vec *restrict y)
{
    for (int32_t i = 0; i < n; i++)
        y[i + step] = vec_sub(y[i + step], pull_of(b, i, x, step));
}

/* Adds the terms of the springs of direction o that start in row j, at those
 * ends that lie in rows from … to - 1. */
static void pull_row(const struct couplings *c, int o, int32_t j, int32_t from,
                     int32_t to)
{
    int32_t di = c->di[o], dj = c->dj[o], first = di < 0 ? -di : 0;
    int32_t n = c->m - (di < 0 ? -di : di);
    int64_t p = first + (int64_t)c->m * j, step = di + (int64_t)c->m * dj;
    int64_t at = o * c->count + p;
    struct edges b = {c->block + at, c->packed ? c->packed + at : NULL};
    if (j < 0 || j + dj >= c->n)
        return;
    if (j >= from && j + dj < to)
        pull_both(n, b, c->x + p, step, c->y + p);
    else if (j >= from)
        pull_first(n, b, c->x + p, step, c->y + p);
    else
        pull_second(n, b, c->x + p, step, c->y + p);
}

void product_couplings(const struct couplings *c)
{
    EACH_MANY(c->count)
    for (int32_t from = 0; from < c->n; from += BAND) {
        int32_t to = c->n - from > BAND ? from + BAND : c->n;
        for (int o = 0; o < c->directions; o++)
            for (int32_t j = from - c->dj[o]; j < to; j++)
                pull_row(c, o, j, from, to);
    }
}

/* §1, cdf: adds A_pq (x_q - x_p) to y_p along one row of one diagonal. */
static void add_blocks(int32_t n, const mat *restrict a, const vec *restrict x,
                       int64_t step, vec *restrict y)
{
    for (int32_t i = 0; i < n; i++) {
        vec d = vec_sub(x[i + step], x[i]);
        y[i] = vec_add(y[i], vec_make(vec_dot(a[i].x, d), vec_dot(a[i].y, d),
                                      vec_dot(a[i].z, d)));
    }
}

static void add_diagonals(const struct product *s, const struct cdf *c,
                          int32_t j)
{
    for (int k = 1; k < DIAGONALS; k++) {
        int o = (k - 1) / 2, sign = k % 2 ? -1 : 1;
        int diagonal = k % 2 ? k + 1 : k - 1; /* backward before forward */
        int32_t di = sign * spring_di[o], b = j + sign * spring_dj[o];
        int32_t first = di < 0 ? -di : 0;
        int64_t p = first + (int64_t)s->m * j;
        if (b >= 0 && b < s->n)
            add_blocks(s->m - (di < 0 ? -di : di),
                       s->cdf + (c->start[diagonal] + p), s->x + p,
                       c->offset[diagonal], s->y + p);
    }
}

/* Adding +0 turns -0 into +0. */
void product_start(const struct product *s)
{
    EACH_MANY(s->count)
    for (int64_t p = 0; p < s->count; p++) {
        vec y = vec_add(vec_scale(s->mass[p], s->x[p]), vec_make(0, 0, 0));
        s->y[p] = s->n_extra ? vec_add(y, sym_apply(s->extra[p], s->x[p])) : y;
    }
}

int ref_product(struct product *s)
{
    struct couplings springs = {.m = s->m,
                                .n = s->n,
                                .count = s->count,
                                .directions = SPRINGS,
                                .di = spring_di,
                                .dj = spring_dj,
                                .block = s->block,
                                .x = s->x,
                                .y = s->y};
    struct cdf c = ref_cdf(s->m, s->n);
    product_start(s);
    if (!s->n_cdf) {
        product_couplings(&springs);
        return DRAPE_OK;
    }
    EACH_MANY(s->count)
    for (int32_t j = 0; j < s->n; j++)
        add_diagonals(s, &c, j);
    return DRAPE_OK;
}
