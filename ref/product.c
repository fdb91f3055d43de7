/* SPDX-License-Identifier: Apache-2.0 */
/* Sparse matrix times vector by differences. spec/12_product.md */
#include "ref/product.h"

/* The particles of a row from which direction o, sign ±1, leads inside. */
struct range {
    int32_t from, to;
};

static struct range reach(const struct product *s, int32_t j, int o, int sign)
{
    struct range r = {0, 0};
    int32_t di = sign * spring_di[o], b = j + sign * spring_dj[o];
    if (b >= 0 && b < s->n) {
        r.from = di < 0 ? -di : 0;
        r.to = di > 0 ? s->m - di : s->m;
    }
    return r;
}

/* y += B (x - x of the neighbour), §1. */
static void add_springs(int32_t n, const sym *b, const vec *x, int64_t step,
                        vec *y)
{
    for (int32_t i = 0; i < n; i++)
        y[i] = vec_add(y[i], sym_apply(b[i], vec_sub(x[i], x[i + step])));
}

/* The same from the blocks -B of the compressed diagonal format. */
static void subtract_blocks(int32_t n, const mat *a, const vec *x, int64_t step,
                            vec *y)
{
    for (int32_t i = 0; i < n; i++) {
        vec d = vec_sub(x[i], x[i + step]);
        vec r = vec_make(vec_dot(a[i].x, d), vec_dot(a[i].y, d),
                         vec_dot(a[i].z, d));
        y[i] = vec_sub(y[i], r);
    }
}

/* All that is not a spring; + 0 turns -0 into +0. */
static void start_row(const struct product *s, int64_t p)
{
    for (int32_t i = 0; i < s->m; i++, p++) {
        vec y = vec_add(vec_scale(s->mass[p], s->x[p]), vec_make(0, 0, 0));
        s->y[p] = s->n_extra ? vec_add(y, sym_apply(s->extra[p], s->x[p])) : y;
    }
}

int ref_product(struct product *s)
{
    struct cdf c = ref_cdf(s->m, s->n);
    EACH_ITEM
    for (int32_t j = 0; j < s->n; j++) {
        int64_t row = (int64_t)s->m * j;
        start_row(s, row);
        for (int k = 1; k < DIAGONALS; k++) {
            int o = (k - 1) / 2, sign = k % 2 ? 1 : -1;
            struct range r = reach(s, j, o, sign);
            int64_t p = row + r.from, step = c.offset[k];
            const vec *x = s->x + p;
            if (s->n_cdf)
                subtract_blocks(r.to - r.from, s->cdf + (c.start[k] + p), x,
                                step, s->y + p);
            else
                add_springs(r.to - r.from,
                            s->block +
                                (o * s->count + p + (sign < 0 ? step : 0)),
                            x, step, s->y + p);
        }
    }
    return DRAPE_OK;
}
