/* SPDX-License-Identifier: Apache-2.0 */
/* The force on each particle: of its springs and triples, of wind and of
 * gravity.
 * spec/cloth/springs.md */
#include "ref/cloth/springs.h"

#include "ref/cloth/law.h"
#include "ref/cloth/triple.h"

/* From particle p to q, §6. */
static vec way_of(const struct springs *s, int64_t p, int64_t q)
{
    vec d = vec_sub(s->x[q], s->x[p]);
    return s->n_u ? vec_axpy(d, s->span, vec_sub(s->u[q], s->u[p])) : d;
}

/* §1: the pull on p of a spring of direction o to q, of which `first` is the
 * first particle. §4: the pull on q is its exact negative. */
static vec pull_of_spring(const struct springs *s, int o, int64_t p, int64_t q,
                          int64_t first)
{
    const struct law *a = &s->law[o];
    vec d = way_of(s, p, q);
    real length = vec_length(d);
    if (!(length > 0))
        return vec_make(0, 0, 0);
    vec u = vec_scale(1 / length, d);
    real f = law_tension(a, s->piece, length);
    if (s->n_v)
        f += a->damp * vec_dot(vec_sub(s->v[q], s->v[p]), u);
    if (s->triples)
        f *= spring_fraction(o, s->beside[first]);
    return vec_scale(f, u);
}

/* §2: the particle at the other end of spring k of p = (i, j); -1 if that
 * spring is not present. Spring 2·o is the forward, 2·o + 1 the backward one of
 * direction o. */
static int64_t other_end(const struct springs *s, int64_t p, int32_t i,
                         int32_t j, int k)
{
    int o = k / 2;
    int32_t di = spring_di[o], dj = spring_dj[o];
    int64_t step = di + (int64_t)dj * s->m;
    if (k % 2 == 0)
        return s->springs[p] >> o & 1 ? p + step : -1;
    if (i < di || i - di >= s->m || j < dj)
        return -1;
    return s->springs[p - step] >> o & 1 ? p - step : -1;
}

/* §2: the sum of the pulls of springs on particle p = (i, j). */
static vec sum_pulls(const struct springs *s, int64_t p, int32_t i, int32_t j)
{
    int ends = 2 * (s->triples ? SPRINGS_SINGLE : SPRINGS);
    vec f = vec_make(0, 0, 0);
    for (int k = 0; k < ends; k++) {
        int64_t q = other_end(s, p, i, j, k);
        if (q >= 0)
            f = vec_add(f, pull_of_spring(s, k / 2, p, q, k % 2 ? q : p));
    }
    return f;
}

/* §5: the force that the triple of direction o with its middle at (i, j) exerts
 * on its ends, with opposite sign; 0 if there is none. */
static vec bending_moment(const struct springs *s, int o, int32_t i, int32_t j)
{
    if (i < 0 || j < 0 || i >= s->m || j >= s->n)
        return vec_make(0, 0, 0);
    int64_t p = i + (int64_t)j * s->m, step = spring_step(s->m, o);
    real k = triple_constant(s->triple, o, s->beside[p]);
    if (!(k > 0))
        return vec_make(0, 0, 0);
    vec t = triple_of(s->x[p - step], s->x[p], s->x[p + step]);
    if (s->n_u)
        t = vec_axpy(t, s->span,
                     triple_of(s->u[p - step], s->u[p], s->u[p + step]));
    return vec_scale(k, t);
}

/* §5: the force of the triples of direction o on particle (i, j). */
static vec unbend_triples(const struct springs *s, int o, int32_t i, int32_t j)
{
    int32_t di = spring_di[o], dj = spring_dj[o];
    vec after = bending_moment(s, o, i + di, j + dj);
    vec before = bending_moment(s, o, i - di, j - dj);
    return vec_sub(vec_scale(2, bending_moment(s, o, i, j)),
                   vec_add(after, before));
}

int ref_springs(struct springs *s)
{
    EACH_ITEM
    for (int64_t p = 0; p < s->count; p++) {
        int32_t j = cloth_row(p, s->m), i = (int32_t)(p - (int64_t)j * s->m);
        vec f = sum_pulls(s, p, i, j);
        for (int o = 0; o < SPRINGS_SINGLE && s->triples; o++)
            f = vec_add(f, unbend_triples(s, o, i, j));
        if (s->n_wind)
            f = vec_add(f, s->wind[p]);
        s->force[p] = vec_axpy(f, s->mass[p], s->gravity);
    }
    return DRAPE_OK;
}
