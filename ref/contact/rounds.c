/* SPDX-License-Identifier: Apache-2.0 */
/* The loops of a round of collision response between its stages.
 * spec/contact/response.md */
#include "ref/contact/rounds.h"

void ref_rounds_start(struct gpu *on, const struct response *s)
{
    (void)on;
    EACH_ITEM
    for (int64_t i = 0; i < s->nv; i++) {
        vec d = vec_sub(s->x1[i], s->x0[i]);
        s->u[i] = vec_make(d.x / s->dt, d.y / s->dt, d.z / s->dt);
    }
}

void ref_rounds_advance(struct gpu *on, const struct response *s, int64_t n,
                        const int32_t *vertex, const uint8_t *moved, bool stop)
{
    (void)on;
    EACH_ITEM
    for (int64_t k = 0; k < n; k++) {
        int32_t i = vertex[k];
        if (moved && !moved[k])
            continue;
        s->x1[i] = vec_axpy(s->x0[i], s->dt, s->u[i]);
        s->touched[i] = 1;
        if (stop)
            s->v[i] = s->u[i];
    }
}

void ref_rounds_touch(struct gpu *on, const struct response *s)
{
    (void)on;
    const int32_t *hit = s->hit.data;
    for (int64_t k = 0; k < 4 * s->hits; k++)
        s->touched[hit[k]] = s->w[hit[k]] > 0;
}

void ref_rounds_settle(struct gpu *on, const struct response *s,
                       struct contact *contact)
{
    (void)on;
    EACH_ITEM
    for (int64_t k = 0; k < s->active; k++) {
        struct contact *c = &contact[k];
        real keep = s->margin * surfaces_pair(&s->surfaces, c->v).thickness;
        c->target = real_min(c->target, (keep - c->gap) / s->dt);
    }
}
