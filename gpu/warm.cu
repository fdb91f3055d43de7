/* SPDX-License-Identifier: Apache-2.0 */
/* What contacts still press with when the next slice begins.
 * spec/39_warm.md */
#include "gpu/contact.cuh"
#include "gpu/gpu.h"
#include "ref/warm.h"

/* Items of a list that are read before the first is added. */
enum { AHEAD = 8 };

/* §1. Thread i owns vertex i: reads its items, writes all[i] if it has some. */
static __global__ void __launch_bounds__(GPU_BLOCK)
    warm_weigh_kernel(struct warm s)
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

/* §1: contact c's share of what corners from … to - 1 took up; false: they are
 * all led. */
static __device__ bool take_side(const struct warm *s, const struct contact *c,
                                 int from, int to, vec *sum)
{
    bool free = false;
    *sum = make(0, 0, 0);
    for (int j = from; j < to; j++) {
        int32_t i = c->v[j];
        if (!(s->w[i] > 0) || c->c[j] == 0)
            continue;
        *sum = axpy(*sum, c->c[j] / s->all[i], s->g[i]);
        free = true;
    }
    return free;
}

/* §2. Thread k owns contact k: reads g and v of its vertices, writes its
 * impulse. */
static __global__ void __launch_bounds__(GPU_BLOCK)
    warm_agree_kernel(struct warm s)
{
    ITEM(k, s.n);
    struct contact *c = &s.contact[k];
    int split = c->kind == CONTACT_VF ? 1 : 2;
    vec a, b;
    real impulse = 0;
    if (c->held) {
        bool free_a = take_side(&s, c, 0, split, &a);
        bool free_b = take_side(&s, c, split, 4, &b);
        a = free_a ? a : b;
        b = free_b ? b : a;
        real push = least(dot(c->n, a), dot(c->n, b));
        real speed = least(dot(c->n, weigh(c, s.v)), R(0.0));
        real give = 0;
        for (int j = 0; j < 4; j++)
            give += c->c[j] * c->c[j] * s.w[c->v[j]];
        if (give > 0)
            impulse = most(push + speed / give, R(0.0));
    }
    c->impulse = impulse;
}

/* §3. Thread i owns vertex i: reads its items in their order, writes press[i].
 * An item that is not there adds 0 to a sum, which is never -0. */
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
    LAUNCH(g, s->nv, warm_weigh_kernel, *s);
    LAUNCH(g, s->n, warm_agree_kernel, *s);
    LAUNCH(g, s->nv, warm_gather_kernel, *s);
    return gpu_status(g);
}
