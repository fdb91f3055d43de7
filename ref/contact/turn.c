/* SPDX-License-Identifier: Apache-2.0 */
/* What a turn of contacts and solves computes besides its stages.
 * spec/contact/penalty.md §4 */
#include "ref/contact/turn.h"

void turn_begin(int64_t n, vec *g, const vec *press, real dt)
{
    EACH_ITEM
    for (int64_t i = 0; i < n; i++)
        g[i] = press ? vec_scale(dt, press[i]) : vec_make(0, 0, 0);
}

void turn_carry(const struct turn *s)
{
    EACH_ITEM
    for (int64_t i = 0; i < s->count; i++)
        s->g[i] = vec_sub(s->g[i], s->r[i]);
}

void turn_load(const struct turn *s)
{
    EACH_ITEM
    for (int64_t i = 0; i < s->count; i++)
        s->b[i] =
            s->fixed[i] ? vec_make(0, 0, 0) : vec_sub(s->force[i], s->g[i]);
}

void turn_move(const struct turn *s)
{
    EACH_ITEM
    for (int64_t i = 0; i < s->count; i++) {
        if (s->fixed[i])
            continue;
        vec dv = s->dv[i];
        vec done =
            vec_sub(vec_sub(s->b[i], s->r[i]), sym_apply(s->hold[i], dv));
        s->g[i] = vec_add(s->g[i], done);
        s->u[i] = vec_axpy(s->u[i], s->span, dv);
        s->v[i] = vec_add(s->v[i], dv);
        s->x1[i] = vec_axpy(s->x0[i], s->dt, s->u[i]);
        s->touched[i] = 1;
    }
}
