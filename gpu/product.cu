/* SPDX-License-Identifier: Apache-2.0 */
/* The system's matrix times a vector. spec/12_product.md */
#include "gpu/product.cuh"

/* Thread p owns y[p]: gathers from its sixteen neighbours. */
static __global__ void __launch_bounds__(GPU_BLOCK)
    product_kernel(struct product s, struct cdf c)
{
    ITEM(item, s.count);
    struct place at = place_of(grid{s.m, s.n}, item);
    s.y[at.p] = system_row(&s, &c, at, s.x);
}

int gpu_product(struct gpu *g, struct product *s)
{
    struct cdf c = cdf_of(s->m, s->n);
    LAUNCH(g, s->count, product_kernel, *s, c);
    return gpu_status(g);
}
