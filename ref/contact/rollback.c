/* SPDX-License-Identifier: Apache-2.0 */
/* Puts the vertices of touching pairs back to the start of the step: the
 * fail-safe, which always ends. spec/contact/rollback.md */
#include "ref/contact/rollback.h"

/* Whether vertex i is free and has not been rolled back. */
static bool can_go(const struct rollback *s, int64_t i)
{
    return s->w[i] > 0 && !s->rolled[i];
}

int ref_rollback(struct rollback *s)
{
    for (int64_t k = 0; k < s->n; k++)
        if (!pair_valid(s->pair + 4 * k, s->nv))
            return DRAPE_EARG;

    memset(s->touched, 0, (size_t)s->nv);
    s->trapped = 0;
    for (int64_t k = 0; k < s->n; k++) {
        bool any = false;
        for (int j = 0; j < 4; j++) {
            int32_t i = s->pair[4 * k + j];
            any |= can_go(s, i);
            s->touched[i] |= can_go(s, i);
        }
        s->trapped += !any;
    }
    bool all = s->all && s->n > s->trapped;
    s->grown = 0;
    for (int64_t i = 0; i < s->nv; i++) {
        s->touched[i] |= all && can_go(s, i);
        s->grown += s->touched[i];
    }
    EACH_ITEM
    for (int64_t i = 0; i < s->nv; i++) {
        if (!s->touched[i])
            continue;
        s->rolled[i] = 1;
        s->x1[i] = s->x0[i];
        s->u[i] = s->v[i] = vec_make(0, 0, 0);
    }
    return DRAPE_OK;
}
