/* SPDX-License-Identifier: Apache-2.0 */
/* Adds the part of fibres and stars to the implicit matrix.
 * spec/panel/joins.md */
#include "ref/panel/joins.h"

#include "ref/cloth/blocks.h"
#include "ref/cloth/law.h"

/* Σ c (a - a_0) over the corners of a cell. */
static vec form_of(const struct fibre *f, const int32_t at[4], const vec *a)
{
    vec d = vec_make(0, 0, 0);
    for (int k = 0; k < 3; k++)
        d = vec_axpy(d, f->c[k], vec_sub(a[at[k + 1]], a[at[0]]));
    return d;
}

/* blocks.md §8: the direction of a fibre half way through the predicted motion.
 */
static vec fibre_direction(const struct joins *s, const int32_t at[4],
                           const struct fibre *f, vec d, real length)
{
    vec way = vec_make(0, 0, 0);
    if (s->n_q)
        way = vec_scale(R(0.5) * s->tau, form_of(f, at, s->q));
    real size = vec_length(way), most = R(BLOCKS_ROTATION) * length;
    if (size > most)
        way = vec_scale(most / size, way);
    vec e = vec_add(d, way);
    real turned = vec_length(e);
    return turned > 0 ? vec_scale(1 / turned, e) : vec_scale(1 / length, d);
}

/* §1: the block of a fibre, blocks.md §1 times its weight. */
static sym fibre_block(const struct joins *s, const int32_t at[4],
                       const struct fibre *f, const struct law *law)
{
    vec d = form_of(f, at, s->x);
    real length = vec_length(d), square = s->tau * s->tau;
    if (!(length > 0))
        return (sym){0, 0, 0, 0, 0, 0};
    real a = s->tau * law->damp + square * law_slope(law, s->piece, length);
    real b = square * real_max(law_tension(law, s->piece, length) / length, 0);
    real c = real_max(a - b, 0);
    vec e = fibre_direction(s, at, f, d, length);
    vec g = vec_scale(real_sqrt(f->weight * c), e);
    b = f->weight * b;
    return (sym){g.x * g.x + b, g.x * g.y, g.x * g.z,
                 g.y * g.y + b, g.y * g.z, g.z * g.z + b};
}

static sym sym_axpy(sym a, real s, sym b)
{
    return (sym){a.xx + s * b.xx, a.xy + s * b.xy, a.xz + s * b.xz,
                 a.yy + s * b.yy, a.yz + s * b.yz, a.zz + s * b.zz};
}

/* §1: the blocks of odd cell k. */
static void join_corners(const struct joins *s, int64_t k)
{
    sym join[CELL_PAIRS];
    memset(join, 0, sizeof join);
    for (int f = 0; f < FIBRES; f++) {
        const struct fibre *a = &s->fibre[k][f];
        if (!(a->weight > 0))
            continue;
        real c[CORNERS] = {-((a->c[0] + a->c[1]) + a->c[2]), a->c[0], a->c[1],
                           a->c[2]};
        sym b = fibre_block(s, s->corner[k], a, &s->law[fibre_law[f]]);
        for (int q = 0; q < CELL_PAIRS; q++)
            join[q] = sym_axpy(join[q],
                               -(c[pair_ends[q][0]] * c[pair_ends[q][1]]), b);
    }
    memcpy(s->join + CELL_PAIRS * k, join, sizeof join);
}

/* §2: the block of pair k gathers its parts. */
static void gather_joins(const struct joins *s, int64_t k)
{
    sym *block = s->block + s->way[k] * s->count + s->first[k], a = *block;
    real bend = s->tau * s->tau * s->bend[k];
    for (int q = 0; q < 2; q++)
        if (s->from[k][q] >= 0)
            a = sym_add(a, s->join[s->from[k][q]]);
    a.xx += bend;
    a.yy += bend;
    a.zz += bend;
    *block = a;
}

int ref_joins(struct joins *s)
{
    EACH_MANY(s->n_cells)
    for (int64_t k = 0; k < s->n_cells; k++)
        join_corners(s, k);
    EACH_MANY(s->n_pairs)
    for (int64_t k = 0; k < s->n_pairs; k++)
        gather_joins(s, k);
    return DRAPE_OK;
}
