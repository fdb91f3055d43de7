/* SPDX-License-Identifier: Apache-2.0 */
/* Bounds the positions and the tangents of whole cloths on the device.
 * spec/broad/extent.md */
#include "gpu/broad/box.cuh"
#include "gpu/broad/cones.cuh"

extern "C" {
#include "ref/broad/extent.h"
}

/* Number of threads in a block, and of blocks for a grid. */
enum { EXTENT_BLOCK = 128, PARTS = EXTENT_BLOCK };

static __device__ struct mesh_bounds join(const struct mesh_bounds &a,
                                          const struct mesh_bounds &b)
{
    return {join(a.box, b.box), join(a.tangents, b.tangents)};
}

/* Returns the neutral element of the join: empty bounds. */
static __device__ struct mesh_bounds no_bounds(void)
{
    const real big = R(INFINITY);
    vec lo = make(big, big, big), hi = make(-big, -big, -big);
    return {{lo, hi, lo, hi}, {lo, hi, lo, hi}};
}

/* Bounds the edges from particle (i, j) to the next particles along i and j, at
 * one end of the step. */
static __device__ struct tangents cell_edges(const struct tree_grid *g,
                                             const vec *x, int32_t i, int32_t j)
{
    struct tangents t = no_bounds().tangents;
    if (i + 1 < g->m)
        t.ulo = t.uhi = sub(x[1], x[0]);
    if (j + 1 < g->n)
        t.vlo = t.vhi = sub(x[g->m], x[0]);
    return t;
}

static __device__ struct mesh_bounds
particle_bounds(const struct extent *s, const struct tree_grid *g, int32_t p)
{
    int32_t i = p % g->m, j = p / g->m;
    const vec *x0 = s->x0 + g->base + p, *x1 = s->x1 + g->base + p;
    return {{*x0, *x0, *x1, *x1},
            join(cell_edges(g, x0, i, j), cell_edges(g, x1, i, j))};
}

/* Joins the values of a block's threads. Thread 0 has the result. */
static __device__ struct mesh_bounds block_join(struct mesh_bounds mine)
{
    __shared__ struct mesh_bounds all[EXTENT_BLOCK];
    int t = (int)threadIdx.x;
    all[t] = mine;
    for (int half = EXTENT_BLOCK / 2; half > 0; half /= 2) {
        __syncthreads();
        if (t < half)
            all[t] = join(all[t], all[t + half]);
    }
    return all[t];
}

/* Block PARTS k + p owns every PARTS-th run of particles of grid k and writes
 * their bounds to its part. */
KERNEL extent_parts_kernel(const struct extent &s, struct mesh_bounds *part,
                           int64_t *bad)
{
    const struct tree_grid *g = &s.grid[blockIdx.x / PARTS];
    struct mesh_bounds w = no_bounds();
    int32_t first = (int32_t)(blockIdx.x % PARTS * EXTENT_BLOCK + threadIdx.x);
    for (int32_t p = first; p < g->m * g->n; p += PARTS * EXTENT_BLOCK) {
        if (!sane(s.x0[g->base + p]) || !sane(s.x1[g->base + p]))
            *bad = 1;
        w = join(w, particle_bounds(&s, g, p));
    }
    w = block_join(w);
    if (threadIdx.x == 0)
        part[blockIdx.x] = w;
}

/* Turns -0 into +0. */
static __device__ vec positive_zero(vec a)
{
    return add(a, make(0, 0, 0));
}

/* Block k joins the parts of grid k and writes bounds[k]. */
KERNEL extent_kernel(struct mesh_bounds *bounds, const struct mesh_bounds *part)
{
    struct mesh_bounds w = block_join(part[blockIdx.x * PARTS + threadIdx.x]);
    if (threadIdx.x != 0)
        return;
    const struct box &b = w.box;
    const struct tangents &t = w.tangents;
    bounds[blockIdx.x] = {{positive_zero(b.lo0), positive_zero(b.hi0),
                           positive_zero(b.lo1), positive_zero(b.hi1)},
                          {positive_zero(t.ulo), positive_zero(t.uhi),
                           positive_zero(t.vlo), positive_zero(t.vhi)}};
}

int gpu_extent(struct gpu *g, struct extent *s)
{
    int64_t *bad = gpu_words(g);
    struct mesh_bounds *part = (struct mesh_bounds *)gpu_scratch(
        g, SLOT_STAGE + 1, s->n_grid * PARTS, sizeof *part);
    LAUNCH_BLOCKS(g, s->n_grid * PARTS, EXTENT_BLOCK, extent_parts_kernel, *s,
                  part, bad);
    LAUNCH_BLOCKS(g, s->n_grid, EXTENT_BLOCK, extent_kernel, s->bounds, part);
    int64_t failed = gpu_read_back(g, 1)[0];
    if (gpu_status(g) != DRAPE_OK)
        return gpu_status(g);
    return failed ? DRAPE_EDATA : DRAPE_OK;
}
