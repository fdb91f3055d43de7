/* SPDX-License-Identifier: Apache-2.0 */
/* The next direction and its product, in one pass. spec/solve/pcg.md §3 */
#ifndef GPU_DIRECTION_CUH
#define GPU_DIRECTION_CUH

#include "gpu/solve/march.cuh"
#include "gpu/solve/pcg.cuh"

/* p = s + β p. §3 */
struct mixed {
    const vec *s, *p;
    const struct course *c;
};

struct mixed_parts {
    bool first;
    vec s, p;
};

static __device__ struct mixed_parts take(const struct mixed *m,
                                          struct place at)
{
    struct mixed_parts x = {m->c->first != 0, m->s[at.p], {0, 0, 0}};
    if (!x.first)
        x.p = m->p[at.p];
    return x;
}

static __device__ vec made(const struct mixed *m, struct mixed_parts x,
                           struct place at)
{
    (void)at;
    return x.first ? x.s : axpy(x.s, m->c->beta, x.p);
}

/* Of A p: writes p[k], q[k] and item[k]. */
struct image {
    const uint8_t *fixed;
    vec *p, *q;
    real *item;
};

static __device__ bool about(const struct image *e, struct place at)
{
    return e->fixed[at.p];
}

static __device__ void arrive(const struct image *e, struct place at,
                              bool fixed, vec x, vec y)
{
    vec q = fixed ? make(0, 0, 0) : y;
    e->p[at.p] = x;
    e->q[at.p] = q;
    e->item[at.p] = dot(x, q);
}

/* The same from the compressed diagonals, p being there. */
static __global__ void __launch_bounds__(GPU_BLOCK)
    pcg_direction_kernel(struct mixed m, vec *p, int64_t count)
{
    ITEM(k, count);
    if (m.c->go)
        p[k] = value_at(&m, place{(int32_t)k, 0, 0});
}

static __global__ void __launch_bounds__(GPU_BLOCK)
    pcg_product_kernel(struct product a, struct cdf d, struct image e,
                       const int32_t *go)
{
    ITEM(k, a.count);
    if (!*go)
        return;
    struct place at = place_of(grid{a.m, a.n}, k);
    arrive(&e, at, about(&e, at), a.x[k], cdf_row(&a, &d, at));
}

#endif
