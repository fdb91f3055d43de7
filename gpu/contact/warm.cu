/* SPDX-License-Identifier: Apache-2.0 */
/* Finds the push of the contacts that the next slice starts with (warm start).
 * spec/contact/warm.md */
#include "gpu/contact/contact.cuh"
#include "gpu/run/gpu.h"

extern "C" {
#include "ref/contact/warm.h"
}

/* Items of a list that are loaded before the first is added. */
enum { AHEAD = 8 };

/* §1. Thread i owns vertex i: reads its items; writes all[i] if it has items.
 */
static __global__ void __launch_bounds__(GPU_BLOCK)
    warm_sum_weights_kernel(struct warm s)
{
    ITEM(i, s.nv);
    int32_t end = s.start[i + 1];
    real sum = 0;
    for (int32_t at = s.start[i]; at < end; at += AHEAD) {
        real a[AHEAD];
        UNROLL
        for (int k = 0; k < AHEAD; k++) {
            int32_t item = s.item[at + k < end ? at + k : at];
            const struct contact *c = &s.contact[item / 4];
            a[k] = at + k < end && c->held ? magnitude(c->c[item % 4]) : 0;
        }
        UNROLL
        for (int k = 0; k < AHEAD; k++)
            sum += a[k];
    }
    s.all[i] = sum;
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
static __global__ void __launch_bounds__(GPU_BLOCK)
    warm_share_push_kernel(struct warm s)
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

/* §3. Thread i owns vertex i: reads its items in their order; writes press[i].
 * Beyond the end of a list 0 is added, which does not change the sum, as the
 * sum is never -0. */
static __global__ void __launch_bounds__(GPU_BLOCK)
    warm_gather_kernel(struct warm s)
{
    ITEM(i, s.nv);
    int32_t end = s.start[i + 1];
    vec sum = make(0, 0, 0);
    for (int32_t at = s.start[i]; at < end; at += AHEAD) {
        vec a[AHEAD];
        UNROLL
        for (int k = 0; k < AHEAD; k++) {
            int32_t item = s.item[at + k < end ? at + k : at];
            const struct contact *c = &s.contact[item / 4];
            real part = at + k < end ? c->c[item % 4] : R(0.0);
            a[k] = scale(part * c->impulse, c->n);
        }
        UNROLL
        for (int k = 0; k < AHEAD; k++)
            sum = add(sum, a[k]);
    }
    s.press[i] = scale(s.part, sum);
}

int gpu_warm(struct gpu *g, struct warm *s)
{
    LAUNCH(g, s->nv, warm_sum_weights_kernel, *s);
    LAUNCH(g, s->n, warm_share_push_kernel, *s);
    LAUNCH(g, s->nv, warm_gather_kernel, *s);
    return gpu_status(g);
}
