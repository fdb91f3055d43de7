/* SPDX-License-Identifier: Apache-2.0 */
/* What a round of collision response computes between its stages, on the
 * device: ref/contact/rounds.c. spec/contact/response.md */
#include "gpu/base/compact.cuh"
#include "gpu/contact/contact.cuh"

extern "C" {
#include "gpu/contact/rounds.h"
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

/* Words of the device: held contacts with a led side, and those that slip. */
enum { HELD, SLIP, WORDS };

/* Whether contact k is held and has a led side; *far: it slips by more than its
 * thickness. */
static __device__ bool slips(const struct response *s, const struct contact *c,
                             bool *far)
{
    *far = false;
    if (!c->held || !has_led((int)c->kind, c->v, s->w))
        return false;
    vec v = pair_sum(c, s->u);
    v = axpy(v, -dot(c->n, v), c->n);
    *far = s->dt * length(v) > surface_of(&s->skin, c->v).thickness;
    return true;
}

/* A block owns COMPACT_BLOCK contacts: counts them. */
KERNEL rounds_slip_kernel(const struct response &s,
                          const struct contact *contact, int64_t *words)
{
    int64_t k = compact_item();
    bool far = false, held = k < s.active && slips(&s, &contact[k], &far);
    int n[2];
    block_compact(held, &n[HELD]);
    block_compact(far, &n[SLIP]);
    if (threadIdx.x < WORDS)
        count_up(&words[threadIdx.x], n[threadIdx.x]);
}

bool gpu_rounds_slip(struct gpu *g, const struct response *s,
                     const struct contact *contact)
{
    int64_t *words = gpu_words(g);
    LAUNCH_PARTS(g, compact_blocks(s->active), COMPACT_BLOCK, 1,
                 rounds_slip_kernel, *s, contact, words);
    const int64_t *seen = gpu_read_back(g, WORDS);
    return seen[SLIP] > 0 && ROUNDS_SLIPPING * seen[SLIP] >= seen[HELD];
}

/* Thread k owns contact k: caps its target at the impact margin. */
KERNEL rounds_settle_kernel(const struct response &s, struct contact *contact)
{
    ITEM(k, s.active);
    struct contact *c = &contact[k];
    real keep = s.margin * surface_of(&s.skin, c->v).thickness;
    c->target = min_of(c->target, (keep - c->gap) / s.dt);
}

void gpu_rounds_settle(struct gpu *g, const struct response *s,
                       struct contact *contact)
{
    LAUNCH(g, s->active, rounds_settle_kernel, *s, contact);
}
