/* SPDX-License-Identifier: Apache-2.0 */
/* The force on each particle: of its springs, of wind and of gravity.
 * spec/cloth/springs.md */
#include "ref/cloth/springs.h"

#include "ref/cloth/law.h"

/* §1: the pull on p of a spring to q. §4: the pull on q is its exact
 * negative. */
static vec pull(const struct springs *s, const struct law *a, int64_t p,
                int64_t q)
{
    vec d = vec_sub(s->x[q], s->x[p]);
    real length = vec_length(d);
    if (!(length > 0))
        return vec_make(0, 0, 0);
    vec u = vec_scale(1 / length, d);
    real f = law_tension(a, length);
    if (s->n_v)
        f += a->damp * vec_dot(vec_sub(s->v[q], s->v[p]), u);
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

int ref_springs(struct springs *s)
{
    EACH_ITEM
    for (int64_t p = 0; p < s->count; p++) {
        int32_t j = cloth_row(p, s->m), i = (int32_t)(p - (int64_t)j * s->m);
        vec f = vec_make(0, 0, 0);
        for (int k = 0; k < 2 * SPRINGS; k++) {
            int64_t q = other_end(s, p, i, j, k);
            if (q >= 0)
                f = vec_add(f, pull(s, &s->law[k / 2], p, q));
        }
        if (s->n_wind)
            f = vec_add(f, s->wind[p]);
        s->force[p] = vec_axpy(f, s->mass[p], s->gravity);
    }
    return DRAPE_OK;
}
