/* SPDX-License-Identifier: Apache-2.0 */
/* Selects the candidates that touch and that a response can part.
 * spec/contact/impacts.md */
#include "ref/contact/impacts.h"

#include "ref/narrow/narrow.h"

enum { MISS = -1, STARTED = -2, PRESCRIBED = -3 };

/* §1: 0 for an impact, which a response can part; else why the candidate is
 * left out. */
static int32_t decide_candidate(const struct impacts *s, int64_t k)
{
    if (s->toi[k] == NARROW_MISS)
        return MISS;
    bool any_free = false;
    for (int j = 0; j < 4; j++)
        any_free |= s->w[s->pair[4 * k + j]] > 0;
    if (!any_free)
        return PRESCRIBED;
    if (s->toi[k] > 0)
        return 0;
    vec x[4];
    int tier;
    for (int j = 0; j < 4; j++)
        x[j] = s->x0[s->pair[4 * k + j]];
    uint32_t toi = s->kind[k] == CONTACT_VF ? narrow_vf(x, x, &tier)
                                            : narrow_ee(x, x, &tier);
    return toi == NARROW_MISS ? 0 : STARTED;
}

int ref_impacts(struct impacts *s)
{
    for (int64_t k = 0; k < s->n; k++)
        if (!pair_valid(s->pair + 4 * k, s->nv) || s->kind[k] > CONTACT_EE)
            return DRAPE_EARG;
    EACH_ITEM
    for (int64_t k = 0; k < s->n; k++)
        s->at[k] = decide_candidate(s, k);

    s->found = s->started = s->prescribed = 0;
    for (int64_t k = 0; k < s->n; k++) {
        s->started += s->at[k] == STARTED;
        s->prescribed += s->at[k] == PRESCRIBED;
        if (s->at[k] == 0)
            s->at[k] = (int32_t)s->found++;
        else
            s->at[k] = MISS;
    }
    if (s->found > s->cap)
        return DRAPE_EFULL;

    EACH_ITEM
    for (int64_t k = 0; k < s->n; k++) {
        int32_t at = s->at[k];
        if (at == MISS)
            continue;
        memcpy(s->hit + 4 * at, s->pair + 4 * k, 4 * sizeof *s->hit);
        s->hit_kind[at] = s->kind[k];
        s->hit_toi[at] = s->toi[k];
    }
    return DRAPE_OK;
}
