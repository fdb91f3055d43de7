/* SPDX-License-Identifier: Apache-2.0 */
/* The box that each vertex sweeps, rounded outwards. spec/20_bounds.md */
#include "ref/bounds.h"

static vec down(vec a)
{
    return vec_make(real_down(a.x), real_down(a.y), real_down(a.z));
}

static vec up(vec a)
{
    return vec_make(real_up(a.x), real_up(a.y), real_up(a.z));
}

int ref_bounds(struct bounds *s)
{
    if (!(s->r >= 0 && s->r <= REAL_BIG))
        return DRAPE_EDATA;
    for (int64_t k = 0; k < s->n; k++)
        if (!vec_sane(s->x0[k]) || !vec_sane(s->x1[k]))
            return DRAPE_EDATA;

    vec r = vec_make(s->r, s->r, s->r);
    EACH_ITEM
    for (int64_t k = 0; k < s->n; k++) {
        s->lo[k] = down(vec_sub(vec_min(s->x0[k], s->x1[k]), r));
        s->hi[k] = up(vec_add(vec_max(s->x0[k], s->x1[k]), r));
    }
    return DRAPE_OK;
}
