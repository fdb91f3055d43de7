/* SPDX-License-Identifier: Apache-2.0 */
/* The elastic energy of fibres and stars, summed by the tree of sum.md.
 * spec/panel/tension.md */
#include "ref/panel/tension.h"

#include "ref/base/sum.h"
#include "ref/cloth/law.h"

static real cell_energy(const struct tension *s, int64_t k)
{
    const int32_t *at = s->corner[k];
    real e = 0;
    for (int f = 0; f < FIBRES; f++) {
        const struct fibre *a = &s->fibre[k][f];
        vec d = vec_make(0, 0, 0);
        if (!(a->weight > 0))
            continue;
        for (int q = 0; q < 3; q++)
            d = vec_axpy(d, a->c[q], vec_sub(s->x[at[q + 1]], s->x[at[0]]));
        e += a->weight *
             law_energy(&s->law[fibre_law[f]], s->piece, vec_length(d));
    }
    return e;
}

static real star_energy(const struct tension *s, int64_t k)
{
    const struct star *a = &s->star[k];
    vec t = vec_make(0, 0, 0);
    for (int q = 0; q < 4; q++)
        t = vec_axpy(t, a->c[q], vec_sub(s->x[a->at[q + 1]], s->x[a->at[0]]));
    return R(0.5) * a->k * vec_dot(t, t);
}

static void sum_chunk(const struct tension *s, int64_t k)
{
    real sum[SUM_CHUNK] = {0};
    int64_t start = k * SUM_CHUNK, all = s->n_cells + s->n_stars;
    for (int64_t i = start; i < start + SUM_CHUNK && i < all; i++)
        sum[i - start] =
            i < s->n_cells ? cell_energy(s, i) : star_energy(s, i - s->n_cells);
    s->chunk[k] = sum_tree(sum);
}

int ref_tension(struct tension *s)
{
    EACH_ITEM
    for (int64_t k = 0; k < s->n_chunks; k++)
        sum_chunk(s, k);
    s->value = ref_sum_finish(s->n_chunks, s->chunk);
    return DRAPE_OK;
}
