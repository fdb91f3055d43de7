/* SPDX-License-Identifier: Apache-2.0 */
/* The loops of a round of collision response between its stages, on the
 * device: ref/contact/rounds.c. spec/contact/response.md */
#include "gpu/contact/contact.cuh"

extern "C" {
#include "gpu/run/backend.h"
#include "ref/contact/rounds.h"
}

/* Thread i owns vertex i: writes u[i]. */
KERNEL rounds_start_kernel(const struct response &s)
{
    ITEM(i, s.nv);
    vec d = sub(s.x1[i], s.x0[i]);
    s.u[i] = make(d.x / s.dt, d.y / s.dt, d.z / s.dt);
}

void gpu_rounds_start(struct gpu *g, const struct response *s)
{
    LAUNCH(g, s->nv, rounds_start_kernel, *s);
}

/* Thread k owns vertex[k]: writes its x1 and touched, and v where it stops. */
KERNEL rounds_advance_kernel(const struct response &s, int64_t n,
                             const int32_t *vertex, const uint8_t *moved,
                             bool stop)
{
    ITEM(k, n);
    if (moved && !moved[k])
        return;
    int32_t i = vertex[k];
    s.x1[i] = axpy(s.x0[i], s.dt, s.u[i]);
    s.touched[i] = 1;
    if (stop)
        s.v[i] = s.u[i];
}

void gpu_rounds_advance(struct gpu *g, const struct response *s, int64_t n,
                        const int32_t *vertex, const uint8_t *moved, bool stop)
{
    LAUNCH(g, n, rounds_advance_kernel, *s, n, vertex, moved, stop);
}

/* Thread k owns corner k of the hits: marks its vertex where it is free. */
KERNEL rounds_touch_kernel(const struct response &s, const int32_t *hit)
{
    ITEM(k, 4 * s.hits);
    s.touched[hit[k]] = s.w[hit[k]] > 0;
}

void gpu_rounds_touch(struct gpu *g, const struct response *s)
{
    LAUNCH(g, 4 * s->hits, rounds_touch_kernel, *s,
           (const int32_t *)s->hit.data);
}

/* Thread k owns contact k: caps its target at the impact margin. */
KERNEL rounds_settle_kernel(const struct response &s, struct contact *contact)
{
    ITEM(k, s.active);
    struct contact *c = &contact[k];
    real keep = s.margin * surface_of(&s.surfaces, c->v).thickness;
    c->target = min_of(c->target, (keep - c->gap) / s.dt);
}

void gpu_rounds_settle(struct gpu *g, const struct response *s,
                       struct contact *contact)
{
    LAUNCH(g, s->active, rounds_settle_kernel, *s, contact);
}
