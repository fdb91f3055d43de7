/* SPDX-License-Identifier: Apache-2.0 */
/* Stage product on the device: the system's matrix times a vector.
 * spec/solve/product.md */
#include "gpu/solve/sweep.cuh"

/* Thread p owns row p of the compressed diagonals and writes y[p]. */
KERNEL product_kernel(const struct product &s, const struct cdf &c)
{
    ITEM(item, s.count);
    struct place at = place_of(grid{s.m, s.n}, item);
    s.y[at.p] = cdf_row(&s, &c, at);
}

struct product_end {
    vec *y;
};

static __device__ int about(const struct product_end *e, struct place at)
{
    (void)e;
    return at.p;
}

static __device__ void arrive(const struct product_end *e, struct place at,
                              int own, vec x, vec y)
{
    (void)x;
    (void)own;
    e->y[at.p] = y;
}

int gpu_product(struct gpu *g, struct product *s)
{
    edges<sym> t = {
        {s->m, s->n}, s->mass, s->n_extra ? s->extra : NULL, NULL, s->block};
    if (s->n_cdf)
        LAUNCH(g, s->count, product_kernel, *s, cdf_of(s->m, s->n));
    else
        product_of<SPRINGS>(g, t, plain{s->x}, product_end{s->y}, NULL);
    return gpu_status(g);
}
