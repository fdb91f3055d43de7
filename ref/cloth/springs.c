/* SPDX-License-Identifier: Apache-2.0 */
/* The force on each particle: its springs, wind, weight.
 * spec/cloth/springs.md */
#include "ref/cloth/springs.h"

#include "ref/cloth/law.h"

/* §1: the pull on p of a spring to q; d = x_q - x_p. Exactly opposite for
 * p and q exchanged. */
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

/* The particle that spring k of p = (i, j) leads to, or -1: forward and
 * backward spring of each direction in turn, §2. */
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
