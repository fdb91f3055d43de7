/* SPDX-License-Identifier: Apache-2.0 */
/* Assembly of the compressed diagonal format. spec/solve/matrix.md */
#include "ref/solve/matrix.h"

struct cdf ref_cdf(int32_t m, int32_t n)
{
    struct cdf c = {{0}, {0}, 0};
    int64_t count = (int64_t)m * n;
    for (int k = 0; k < DIAGONALS; k++) {
        int64_t step = k ? spring_step(m, (k - 1) / 2) : 0;
        c.offset[k] = k % 2 ? step : -step;
        int64_t first = c.offset[k] < 0 ? -c.offset[k] : 0;
        c.start[k] = c.blocks - first;
        if (step < count)
            c.blocks += count - step;
    }
    return c;
}

/* §2: returns the diagonal block of p, at (i, j). */
static sym diagonal_block(const struct matrix *s, int32_t i, int32_t j)
{
    int64_t p = i + (int64_t)s->m * j;
    real mass = s->mass[p];
    sym d = {mass, 0, 0, mass, 0, mass};
    if (s->n_extra)
        d = sym_add(d, s->extra[p]);
    for (int o = 0; o < SPRINGS; o++) {
        const sym *block = s->block + o * s->count;
        if (spring_inside(s->m, s->n, i, j, o, 1))
            d = sym_add(d, block[p]);
        if (spring_inside(s->m, s->n, i, j, o, -1))
            d = sym_add(d, block[p - spring_step(s->m, o)]);
    }
    return d;
}

/* 0 - b and not -b, so that a missing block gives +0. */
static mat negate_block(sym b)
{
    mat a = {vec_make(0 - b.xx, 0 - b.xy, 0 - b.xz),
             vec_make(0 - b.xy, 0 - b.yy, 0 - b.yz),
             vec_make(0 - b.xz, 0 - b.yz, 0 - b.zz)};
    return a;
}

/* §3: writes row p of each diagonal that has a row p. */
static void fill_row(const struct matrix *s, const struct cdf *c, int32_t i,
                     int32_t j)
{
    int64_t p = i + (int64_t)s->m * j;
    sym d = s->diagonal[p], none = {0, 0, 0, 0, 0, 0};
    mat main = {vec_make(d.xx, d.xy, d.xz), vec_make(d.xy, d.yy, d.yz),
                vec_make(d.xz, d.yz, d.zz)};
    s->cdf[c->start[0] + p] = main;
    for (int k = 1; k < DIAGONALS; k++) {
        int64_t q = p + c->offset[k];
        if (q < 0 || q >= s->count)
            continue;
        int o = (k - 1) / 2, sign = k % 2 ? 1 : -1;
        bool spring = spring_inside(s->m, s->n, i, j, o, sign);
        int64_t from = o * s->count + (sign > 0 ? p : q);
        s->cdf[c->start[k] + p] = negate_block(spring ? s->block[from] : none);
    }
}

int ref_matrix(struct matrix *s)
{
    struct cdf c = ref_cdf(s->m, s->n);
    if (s->m < 1 || s->n < 1 || s->count != (int64_t)s->m * s->n ||
        s->n_blocks != SPRINGS * s->count ||
        (s->n_extra && s->n_extra != s->count) ||
        (s->n_cdf && s->n_cdf != c.blocks))
        return DRAPE_EARG;

    EACH_ITEM
    for (int32_t j = 0; j < s->n; j++)
        for (int32_t i = 0; i < s->m; i++) {
            s->diagonal[i + (int64_t)s->m * j] = diagonal_block(s, i, j);
            if (s->n_cdf)
                fill_row(s, &c, i, j);
        }
    return DRAPE_OK;
}
