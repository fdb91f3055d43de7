/* SPDX-License-Identifier: Apache-2.0 */
/* The stages before and after the linear solve of an implicit step. predict,
 * update and imbalance give each coordinate a thread. spec/cloth/implicit.md */
#include "gpu/cloth/cloth.cuh"

extern "C" {
#include "ref/cloth/implicit.h"
}

static __device__ const real *flat(const vec *a)
{
    return &a->x;
}

static __device__ real *flat(vec *a)
{
    return &a->x;
}

/* (x - past) / 3: the share of the step before in the second-order method. */
static __device__ real past_drift(real x, real past)
{
    return R(1.0 / 3) * (x - past);
}

/* Thread k owns coordinate k of 3·count in every stream. Any order. */
KERNEL predict_kernel(const struct predict &s)
{
    ITEM(k, 3 * s.count);
    uint8_t fixed = s.fixed[(uint32_t)k / 3];
    real star = flat(s.v)[k], move = 0;
    if (s.n_past) {
        move = past_drift(flat(s.x)[k], flat(s.xp)[k]);
        star = star + past_drift(star, flat(s.vp)[k]);
    }
    if (fixed == CLOTH_PINNED)
        star = 1 / s.tau * ((flat(s.to)[k] - flat(s.x)[k]) - move);
    flat(s.star)[k] = star;
    if (s.n_past) {
        real back = -1 / s.tau * move;
        flat(s.back)[k] = back;
        flat(s.q)[k] = star - back;
    }
}

/* Thread k owns coordinate k of 3·count in every stream. Any order. */
KERNEL update_kernel(const struct update &s)
{
    ITEM(k, 3 * s.count);
    uint8_t fixed = s.fixed[(uint32_t)k / 3];
    real x = flat(s.x)[k], v = 0;
    if (fixed == 0) {
        v = flat(s.star)[k] + s.part * flat(s.dv)[k];
        if (s.n_past)
            x = x + past_drift(x, flat(s.xp)[k]);
        x = x + s.tau * v;
    } else if (fixed == CLOTH_PINNED) {
        real to = flat(s.to)[k];
        v = 1 / s.dt * (to - x);
        x = to;
    }
    flat(s.x1)[k] = x;
    flat(s.v1)[k] = v;
}

/* Loads a block of six reals. The stream is aligned to two reals, so three
 * loads suffice. */
static __device__ sym load(const sym *a)
{
    sym r;
    memcpy(&r, __builtin_assume_aligned(a, 2 * sizeof(real)), sizeof r);
    return r;
}

static __device__ vec pull(const sym *block, vec here, vec other)
{
    return apply(load(block), sub(here, other));
}

/* Thread p owns particle p: reads q and the blocks of p's springs, writes b[p].
 * §2: for each direction the forward, then the backward spring. */
KERNEL rhs_kernel(const struct rhs &s)
{
    ITEM(k, s.count);
    int32_t p = (int32_t)k, j = p / s.m, i = p - j * s.m;
    if (s.fixed[p]) {
        s.b[p] = make(0, 0, 0);
        return;
    }
    vec f = make(0, 0, 0), here = s.q[p];
    int mask = s.springs[p];
    for (int o = 0; o < SPRINGS; o++) {
        const sym *block = s.block + o * s.count;
        int32_t di = forward_i(o), dj = forward_j(o), step = di + dj * s.m;
        if (mask >> o & 1)
            f = add(f, pull(block + p, here, s.q[p + step]));
        bool inside = i >= di && i - di < s.m && j >= dj;
        if (inside && s.springs[p - step] >> o & 1)
            f = add(f, pull(block + (p - step), here, s.q[p - step]));
    }
    s.b[p] = sub(scale(s.tau, s.force[p]), f);
}

/* Thread k owns coordinate k of 3·count in every stream, and reads the mass of
 * its particle. Any order. */
KERNEL imbalance_kernel(const struct imbalance &s)
{
    ITEM(k, 3 * s.count);
    uint32_t p = (uint32_t)k / 3;
    real b = 0;
    if (!s.fixed[p])
        b = s.tau * flat(s.force)[k] +
            -s.mass[p] * (flat(s.v)[k] - flat(s.star)[k]);
    flat(s.b)[k] = b;
}

static __device__ bool is_same(vec a, vec b)
{
    return a.x == b.x && a.y == b.y && a.z == b.z;
}

/* Thread p owns particle p in every stream. Any order. */
KERNEL history_kernel(const struct history &s)
{
    ITEM(p, s.count);
    vec x = s.x[p], v = s.v[p], v1 = s.v1[p], xp = s.x0[p], vp = s.v0[p];
    if (s.n_jump)
        vp = axpy(vp, s.part, s.jump[p]);
    if (!is_same(x, s.x1[p]) || !is_same(v, v1)) {
        vp = add(vp, sub(v, v1));
        xp = axpy(x, R(-0.5) * s.dt, add(v, vp));
    }
    s.xp[p] = xp;
    s.vp[p] = vp;
}

int gpu_predict(struct gpu *g, struct predict *s)
{
    LAUNCH(g, 3 * s->count, predict_kernel, *s);
    return gpu_status(g);
}

int gpu_rhs(struct gpu *g, struct rhs *s)
{
    LAUNCH(g, s->count, rhs_kernel, *s);
    return gpu_status(g);
}

int gpu_update(struct gpu *g, struct update *s)
{
    LAUNCH(g, 3 * s->count, update_kernel, *s);
    return gpu_status(g);
}

int gpu_imbalance(struct gpu *g, struct imbalance *s)
{
    LAUNCH(g, 3 * s->count, imbalance_kernel, *s);
    return gpu_status(g);
}

int gpu_history(struct gpu *g, struct history *s)
{
    LAUNCH(g, s->count, history_kernel, *s);
    return gpu_status(g);
}
