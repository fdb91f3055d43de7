/* SPDX-License-Identifier: Apache-2.0 */
/* Finds the push of the contacts that the next slice starts with (warm start).
 * spec/contact/warm.md */
#include "gpu/contact/contact.cuh"
#include "gpu/contact/lists.cuh"
#include "gpu/run/gpu.h"

extern "C" {
#include "ref/contact/warm.h"
}

/* The weights of the held contacts of a vertex. */
struct warm_weights {
    struct warm s;
    const int32_t *start;
    __device__ int32_t end(int64_t i) const { return start[i + 1]; }
    __device__ real value(int32_t at) const
    {
        int32_t item = s.item[at];
        const struct contact *c = &s.contact[item / 4];
        return c->held ? magnitude(c->c[item % 4]) : R(0.0);
    }
    __device__ real first(int64_t) const { return 0; }
    __device__ void done(int64_t i, real sum) const { s.all[i] = sum; }
};

/* §1. Thread i owns vertex i: reads its items, writes all[i]. */
KERNEL warm_sum_weights_kernel(const struct warm &s)
{
    sum_list(warm_weights{s, s.start}, own_list(s.nv));
}

/* §2: the impulse along n that vertex j of contact c took up, up to the limit
 * that keeps an impact out of the next slice. */
static __device__ real kept_impulse(const struct warm &s,
                                    const struct contact *c, int j)
{
    int32_t i = c->v[j];
    real now = dot(c->n, s.g[i]), before = dot(c->n, s.before[i]);
    if (c->c[j] < 0) {
        now = -now;
        before = -before;
    }
    return min_of(now, s.again * max_of(before, R(0.0)) + s.speed / s.w[i]);
}

/* §2. Thread k owns contact k: reads g, before, all and v of its vertices,
 * writes its impulse. */
KERNEL warm_share_push_kernel(const struct warm &s)
{
    ITEM(k, s.n);
    struct contact *c = &s.contact[k];
    real push = R(0x1p60), give = 0, impulse = 0;
    for (int j = 0; j < 4 && c->held; j++) {
        int32_t i = c->v[j];
        if (!(s.w[i] > 0) || c->c[j] == 0)
            continue;
        push = min_of(kept_impulse(s, c, j) / s.all[i], push);
        give += c->c[j] * c->c[j] * s.w[i];
    }
    if (give > 0) {
        real speed = min_of(dot(c->n, pair_sum(c, s.v)), R(0.0));
        impulse = max_of(push + speed / give, R(0.0));
    }
    c->impulse = impulse;
}

/* The impulses of the contacts of a vertex. */
struct warm_impulses {
    struct warm s;
    const int32_t *start;
    __device__ int32_t end(int64_t i) const { return start[i + 1]; }
    __device__ vec value(int32_t at) const
    {
        int32_t item = s.item[at];
        const struct contact *c = &s.contact[item / 4];
        return scale(c->c[item % 4] * c->impulse, c->n);
    }
    __device__ vec first(int64_t) const { return make(0, 0, 0); }
    __device__ void done(int64_t i, vec sum) const
    {
        s.press[i] = scale(s.part, sum);
    }
};

/* §3. Thread i owns vertex i: reads its items in their order; writes press[i].
 */
KERNEL warm_gather_kernel(const struct warm &s)
{
    sum_list(warm_impulses{s, s.start}, own_list(s.nv));
}

int gpu_warm(struct gpu *g, struct warm *s)
{
    LAUNCH_LISTS(g, s->nv, warm_sum_weights_kernel, *s);
    LAUNCH(g, s->n, warm_share_push_kernel, *s);
    LAUNCH_LISTS(g, s->nv, warm_gather_kernel, *s);
    return gpu_status(g);
}
