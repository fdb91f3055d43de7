/* SPDX-License-Identifier: Apache-2.0 */
/* The true residual, in binary64 and rounded once. spec/solve/pcg.md §2 */
#include "ref/base/wide.h"
#include "ref/solve/matrix.h"
#include "ref/solve/pcg.h"

static struct wide solution_of(const struct pcg *s, int64_t p)
{
    struct wide x = wide_of(s->dv[p]), low = wide_of(s->low[p]);
    return wide_make(x.x + low.x, x.y + low.y, x.z + low.z);
}

/* Returns r - a d. */
static struct wide subtract_product(struct wide r, sym a, struct wide d)
{
    struct wide x = {(double)a.xx, (double)a.xy, (double)a.xz};
    struct wide y = {(double)a.xy, (double)a.yy, (double)a.yz};
    struct wide z = {(double)a.xz, (double)a.yz, (double)a.zz};
    struct wide f = {wide_dot(x, d), wide_dot(y, d), wide_dot(z, d)};
    return wide_sub(r, f);
}

/* §2: returns b - A (dv + low) at the particle (i, j), rounded once. */
static vec left_over(const struct pcg *s, int32_t i, int32_t j)
{
    int64_t p = i + (int64_t)s->m * j;
    struct wide x = solution_of(s, p);
    struct wide r = wide_axpy(wide_of(s->b[p]), -(double)s->mass[p], x);
    if (s->n_extra)
        r = subtract_product(r, s->extra[p], x);
    for (int o = 0; o < SPRINGS; o++) {
        const sym *block = s->block + o * s->count;
        int64_t step = spring_step(s->m, o), before = p - step;
        if (spring_inside(s->m, s->n, i, j, o, -1))
            r = subtract_product(r, block[before],
                                 wide_sub(x, solution_of(s, before)));
        if (spring_inside(s->m, s->n, i, j, o, 1))
            r = subtract_product(r, block[p],
                                 wide_sub(x, solution_of(s, p + step)));
    }
    return wide_round(r);
}

void residual_find(const struct pcg *s)
{
    EACH_MANY(s->count)
    for (int32_t j = 0; j < s->n; j++)
        for (int32_t i = 0; i < s->m; i++) {
            int64_t p = i + (int64_t)s->m * j;
            s->r[p] = s->fixed[p] ? vec_make(0, 0, 0) : left_over(s, i, j);
        }
}
