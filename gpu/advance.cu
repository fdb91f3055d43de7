/* SPDX-License-Identifier: Apache-2.0 */
/* The update that every explicit method is made of. spec/06_advance.md */
#include "gpu/real.cuh"

/* The streams as their coordinates: one thread each, so that neighbours in a
 * warp are neighbours in memory. */
struct coordinates {
    const real *x, *v, *rate, *force, *from, *to;
    real *x1, *v1;
};

/* Thread k owns coordinate k of 3·count: reads it in all streams, then writes
 * x1 and v1, which may be x and v. Any order. */
static __global__ void __launch_bounds__(GPU_BLOCK)
    advance_kernel(struct advance s, struct coordinates c)
{
    ITEM(k, 3 * s.count);
    uint32_t p = (uint32_t)k / 3;
    real x = c.x[k], v = c.v[k];
    uint8_t fixed = s.fixed[p];
    if (fixed == 0) {
        real rate = s.symplectic ? 0 : c.rate[k];
        v = v + s.b / s.mass[p] * c.force[k];
        x = x + s.a * (s.symplectic ? v : rate);
    } else if (fixed == CLOTH_PINNED) {
        real from = c.from[k], to = c.to[k], d = to - from;
        x = s.at < 1 ? from + s.at * d : to;
        v = 1 / s.dt * d;
    }
    c.x1[k] = x;
    c.v1[k] = v;
}

int gpu_advance(struct gpu *g, struct advance *s)
{
    struct coordinates c = {(const real *)s->x,    (const real *)s->v,
                            (const real *)s->rate, (const real *)s->force,
                            (const real *)s->from, (const real *)s->to,
                            (real *)s->x1,         (real *)s->v1};
    LAUNCH(g, 3 * s->count, advance_kernel, *s, c);
    return gpu_status(g);
}
