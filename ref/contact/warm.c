/* SPDX-License-Identifier: Apache-2.0 */
/* Finds the push of the contacts that the next slice starts with (warm start).
 * spec/contact/warm.md */
#include "ref/contact/warm.h"

/* §1: the sum of the weights |c| of vertex i in its held contacts. */
static void sum_weights(struct warm *s, int64_t i)
{
    real sum = 0;
    for (int32_t k = s->start[i]; k < s->start[i + 1]; k++) {
        const struct contact *c = &s->contact[s->item[k] / 4];
        if (c->held)
            sum += real_abs(c->c[s->item[k] % 4]);
    }
    s->all[i] = sum;
}

/* §2: the impulse along n that vertex j of contact c took up, up to the limit
 * that keeps an impact out of the next slice. */
static real kept_impulse(const struct warm *s, const struct contact *c, int j)
{
    int32_t i = c->v[j];
    real now = vec_dot(c->n, s->g[i]), before = vec_dot(c->n, s->before[i]);
    if (c->c[j] < 0) {
        now = -now;
        before = -before;
    }
    real most = s->again * real_max(before, 0) + s->speed / s->w[i];
    return real_min(now, most);
}

/* §2: λ of contact k: the smallest share among its free vertices, less the
 * impulse that stopped an approach. */
static void share_push(struct warm *s, int64_t k)
{
    struct contact *c = &s->contact[k];
    real push = R(0x1p60), give = 0;
    c->impulse = 0;
    if (!c->held)
        return;
    for (int j = 0; j < 4; j++) {
        int32_t i = c->v[j];
        if (!(s->w[i] > 0) || c->c[j] == 0)
            continue;
        push = real_min(kept_impulse(s, c, j) / s->all[i], push);
        give += c->c[j] * c->c[j] * s->w[i];
    }
    real speed = real_min(vec_dot(c->n, pair_sum(c->v, c->c, s->v)), 0);
    if (give > 0)
        c->impulse = real_max(push + speed / give, 0);
}

/* §3: the press of vertex i. */
static void gather(struct warm *s, int64_t i)
{
    vec sum = vec_make(0, 0, 0);
    for (int32_t k = s->start[i]; k < s->start[i + 1]; k++) {
        const struct contact *c = &s->contact[s->item[k] / 4];
        sum = vec_axpy(sum, c->c[s->item[k] % 4] * c->impulse, c->n);
    }
    s->press[i] = vec_scale(s->part, sum);
}

int ref_warm(struct warm *s)
{
    EACH_ITEM
    for (int64_t i = 0; i < s->nv; i++)
        sum_weights(s, i);
    EACH_ITEM
    for (int64_t k = 0; k < s->n; k++)
        share_push(s, k);
    EACH_ITEM
    for (int64_t i = 0; i < s->nv; i++)
        gather(s, i);
    return DRAPE_OK;
}
