/* SPDX-License-Identifier: Apache-2.0 */
/* Multipliers go on from slice to slice by the keys of pairs, on the device.
 * spec/contact/carry.md */
#include "gpu/contact/keys.cuh"

extern "C" {
#include "gpu/contact/queue.h"
#include "ref/contact/carry.h"
#include "ref/contact/impulses.h"
}

/* The place in `kept` of what was kept of a pair, or -1. */
static __device__ int64_t find_kept(const struct carry *s, struct key key)
{
    int64_t from = 0, end = s->n_kept;
    while (from < end) {
        int64_t middle = from + (end - from) / 2;
        struct kept k = s->kept[middle];
        bool before = k.hi < key.hi || (k.hi == key.hi && k.lo < key.lo);
        from = before ? middle + 1 : from;
        end = before ? end : middle;
    }
    bool found = from < s->n_kept && s->kept[from].hi == key.hi &&
                 s->kept[from].lo == key.lo;
    return found ? from : -1;
}

/* §1: -1 where the pair names its edges in the other order than its key. */
static __device__ real order_of(const struct contact *c, struct key key)
{
    bool same = c->kind == CONTACT_VF ||
                (key.hi & ~KEY_EDGES) == key_edge(c->v[0], c->v[1]);
    return same ? R(1.0) : R(-1.0);
}

/* §1: the multipliers of a new contact. */
static __device__ void take_over(const struct carry *s, struct contact *c)
{
    struct key key = pair_key(c->v, c->kind, 0);
    int64_t at = find_kept(s, key);
    if (at >= 0) {
        vec t = scale(order_of(c, key), s->kept[at].lambda_t);
        c->lambda = s->kept[at].lambda;
        c->lambda_t = axpy(t, -dot(c->n, t), c->n);
    }
    c->load = c->lambda;
}

/* §1.2 */
static __device__ real kappa_of(const struct carry *s, const struct contact *c,
                                real thickness)
{
    real y = 0, wanted = 0;
    for (int j = 0; j < 4; j++)
        y += c->c[j] * c->c[j] * s->w[c->v[j]];
    if (c->lambda > 0)
        wanted = c->lambda * s->tau / (CONTACT_GIVE * thickness);
    return y > 0 ? max_of(CARRY_KAPPA / y, min_of(wanted, s->stiffest))
                 : R(0.0);
}

/* Thread k owns contact k. */
KERNEL carry_kernel(const struct carry &s, int64_t *bad)
{
    ITEM(k, s.n);
    struct contact *c = &s.contact[k];
    if (!in_range(c->v, s.nv)) {
        *bad = 1;
        return;
    }
    real thickness = surface_of(&s.surfaces, c->v).thickness;
    real overlap = thickness - c->gap;
    c->target = (overlap > 0 ? CARRY_RISE * overlap : overlap) / s.dt;
    if (c->kappa > 0)
        return;
    take_over(&s, c);
    c->kappa = kappa_of(&s, c, thickness);
}

/* §2: whether a contact of this slice struck a side of it. */
static __device__ bool is_struck(const struct retain *s,
                                 const struct contact *c)
{
    int split = c->kind == CONTACT_VF ? 1 : 2;
    bool moves[SIDES] = {false, false};
    real jump[SIDES] = {0, 0};
    for (int j = 0; j < 4; j++) {
        int32_t i = c->v[j], side = j < split ? SIDE_A : SIDE_B;
        moves[side] = moves[side] || s->w[i] > 0;
        jump[side] += c->c[j] * dot(c->n, sub(s->u[i], s->v[i]));
    }
    return (moves[SIDE_A] && magnitude(jump[SIDE_A]) > s->most) ||
           (moves[SIDE_B] && magnitude(jump[SIDE_B]) > s->most);
}

/* Thread k owns contact k and writes kept[k]. */
KERNEL retain_kernel(const struct retain &s, int64_t *bad)
{
    ITEM(k, s.n);
    const struct contact *c = &s.contact[k];
    if (!in_range(c->v, s.nv)) {
        *bad = 1;
        return;
    }
    struct key key = pair_key(c->v, c->kind, 0);
    struct kept r = {key.hi, key.lo, 0, make(0, 0, 0)};
    if (c->impulse > 0 && !is_struck(&s, c)) {
        r.lambda = c->impulse;
        r.lambda_t = scale(order_of(c, key), c->tangent);
    }
    s.kept[k] = r;
}

int gpu_carry_queue(struct gpu *g, const struct carry *s, int64_t *bad)
{
    if (!(s->dt > 0 && s->tau > 0 && s->stiffest > 0) || s->n_kept < 0)
        return DRAPE_EARG;
    LAUNCH(g, s->n, carry_kernel, *s, bad);
    return gpu_status(g);
}

int gpu_retain_queue(struct gpu *g, const struct retain *s, int64_t *bad)
{
    if (!(s->most >= 0))
        return DRAPE_EARG;
    LAUNCH(g, s->n, retain_kernel, *s, bad);
    return gpu_status(g);
}

static int status_of(struct gpu *g, int queued)
{
    if (queued != DRAPE_OK)
        return queued;
    return gpu_read_back(g, 1)[0] ? DRAPE_EARG : gpu_status(g);
}

int gpu_carry(struct gpu *g, struct carry *s)
{
    return status_of(g, gpu_carry_queue(g, s, gpu_words(g)));
}

int gpu_retain(struct gpu *g, struct retain *s)
{
    return status_of(g, gpu_retain_queue(g, s, gpu_words(g)));
}
