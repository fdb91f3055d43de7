/* SPDX-License-Identifier: Apache-2.0 */
/* Computes a positive semidefinite 3 × 3 block for each spring.
 * spec/cloth/blocks.md */
#include "ref/cloth/blocks.h"

#include "ref/cloth/law.h"

/* §1: the block c u uᵀ + b I, where c = a − b and u is the direction. */
struct parts {
    real b, c;
    vec u;
};

static struct parts spring_parts(const struct law *law, real tau, vec d)
{
    struct parts s = {0, 0, {0, 0, 0}};
    real length = vec_length(d);
    if (!(length > 0))
        return s;
    real square = tau * tau;
    real a = tau * law->damp + square * law_slope(law, length);
    s.b = square * real_max(law_tension(law, length) / length, 0);
    s.c = a - s.b;
    s.u = vec_scale(1 / length, d);
    return s;
}

static sym whole_block(const struct parts *s)
{
    vec u = s->u, w = vec_scale(s->c, u);
    return (sym){w.x * u.x + s->b, w.x * u.y, w.x * u.z,
                 w.y * u.y + s->b, w.y * u.z, w.z * u.z + s->b};
}

int ref_blocks(struct blocks *s)
{
    for (int o = 0; o < SPRINGS; o++) {
        int64_t step = spring_di[o] + (int64_t)spring_dj[o] * s->m;
        sym *block = s->block + o * s->count;
        EACH_ITEM
        for (int64_t p = 0; p < s->count; p++) {
            bool is = s->springs[p] >> o & 1;
            vec d = is ? vec_sub(s->x[p + step], s->x[p]) : vec_make(0, 0, 0);
            struct parts a = spring_parts(&s->law[o], s->tau, d);
            block[p] = whole_block(&a);
            if (s->n_thin)
                s->thin[o * s->count + p] = thin_make(a.c, a.b, a.u);
        }
    }
    return DRAPE_OK;
}
