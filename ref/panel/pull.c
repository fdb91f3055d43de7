/* SPDX-License-Identifier: Apache-2.0 */
/* Adds the forces of the fibres of odd cells and of stars.
 * spec/panel/pull.md */
#include "ref/panel/pull.h"

#include "ref/cloth/law.h"

/* From particle p to q (springs.md §6). */
static vec way_of(const struct pull *s, int32_t p, int32_t q)
{
    vec d = vec_sub(s->x[q], s->x[p]);
    return s->n_u ? vec_axpy(d, s->span, vec_sub(s->u[q], s->u[p])) : d;
}

/* §1: the tension of a fibre, as a vector. */
static vec fibre_tension(const struct pull *s, const int32_t at[4],
                         const struct fibre *a, const struct law *law)
{
    vec d = vec_make(0, 0, 0), rate = vec_make(0, 0, 0);
    for (int k = 0; k < 3; k++)
        d = vec_axpy(d, a->c[k], way_of(s, at[0], at[k + 1]));
    real length = vec_length(d);
    if (!(length > 0))
        return vec_make(0, 0, 0);
    vec e = vec_scale(1 / length, d);
    real f = law_tension(law, s->piece, length);
    for (int k = 0; k < 3 && s->n_v; k++)
        rate = vec_axpy(rate, a->c[k], vec_sub(s->v[at[k + 1]], s->v[at[0]]));
    if (s->n_v)
        f += law->damp * vec_dot(rate, e);
    return vec_scale(a->weight * f, e);
}

/* §1: the forces of odd cell k on its corners. */
static void push_corners(const struct pull *s, int64_t k)
{
    vec push[CORNERS] = {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}, {0, 0, 0}};
    for (int f = 0; f < FIBRES; f++) {
        const struct fibre *a = &s->fibre[k][f];
        if (!(a->weight > 0))
            continue;
        vec t = fibre_tension(s, s->corner[k], a, &s->law[fibre_law[f]]);
        for (int q = 1; q < CORNERS; q++)
            push[q] = vec_axpy(push[q], -a->c[q - 1], t);
    }
    vec sum = vec_add(vec_add(push[1], push[2]), push[3]);
    push[0] = vec_sub(vec_make(0, 0, 0), sum);
    memcpy(s->pushes + CORNERS * k, push, sizeof push);
}

/* §2: what particle k of the list gathers. */
static void gather_pushes(const struct pull *s, int64_t k)
{
    int32_t p = s->part[k];
    vec f = s->force[p];
    for (int q = 0; q < 4; q++)
        if (s->push[k][q] >= 0)
            f = vec_add(f, s->pushes[s->push[k][q]]);
    for (int q = 0; q < 2 * SPRINGS; q++) {
        int32_t pair = s->tie[k][q];
        int32_t step = (int32_t)spring_step(s->m, q / 2);
        if (pair >= 0)
            f = vec_axpy(f, s->bend[pair],
                         way_of(s, p, q % 2 ? p - step : p + step));
    }
    s->force[p] = f;
}

int ref_pull(struct pull *s)
{
    EACH_MANY(s->n_cells)
    for (int64_t k = 0; k < s->n_cells; k++)
        push_corners(s, k);
    EACH_MANY(s->n_parts)
    for (int64_t k = 0; k < s->n_parts; k++)
        gather_pushes(s, k);
    return DRAPE_OK;
}
