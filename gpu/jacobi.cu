/* SPDX-License-Identifier: Apache-2.0 */
/* Block-Jacobi preconditioner. spec/13_jacobi.md */
#include "gpu/jacobi.cuh"

#include "gpu/grid.cuh"

/* Thread p owns factor[p]: reads mass, extra and the blocks at p. */
static __global__ void __launch_bounds__(GPU_BLOCK)
    jacobi_kernel(struct jacobi s)
{
    ITEM(item, s.count);
    struct grid g = {s.m, s.n};
    struct place at = place_of(g, item);
    if (s.fixed[at.p]) {
        s.factor[at.p] = sym{0, 0, 0, 0, 0, 0};
        return;
    }
    struct wide_sym d = widened(s.mass[at.p]);
    if (s.n_extra)
        d = add(d, s.extra[at.p]);
    for (int o = 0; o < SPRINGS; o++) {
        const sym *block = s.block + o * s.count;
        int di = forward_i(o), dj = forward_j(o);
        if (within(g, at.i + di, at.j + dj))
            d = add(d, block[at.p]);
        if (within(g, at.i - di, at.j - dj))
            d = add(d, block[at.p - (di + s.m * dj)]);
    }
    s.factor[at.p] = factored(d);
}

int gpu_jacobi(struct gpu *g, struct jacobi *s)
{
    LAUNCH(g, s->count, jacobi_kernel, *s);
    return gpu_status(g);
}
