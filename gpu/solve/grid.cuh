/* SPDX-License-Identifier: Apache-2.0 */
/* Grids of particles on the device, and who is tied to whom: by the springs
 * of a cloth, or by the couplings of a coarse grid. spec/solve/matrix.md,
 * spec/solve/multigrid.md §2 */
#ifndef GPU_GRID_CUH
#define GPU_GRID_CUH

#include "gpu/cloth/cloth.cuh"

extern "C" {
#include "ref/solve/coarsen.h"
}

struct grid {
    int32_t m, n; /* particles along i and j; m·n ≤ 2^30 */
};

/* Particle p = i + m·j. */
struct place {
    int32_t p, i, j;
};

static __device__ inline struct place place_of(struct grid g, int64_t item)
{
    int32_t p = (int32_t)item, j = p / g.m;
    return place{p, p - j * g.m, j};
}

/* Forward direction o of DIRECTIONS: SPRINGS or STENCIL of them. */
template <int DIRECTIONS>
static __host__ __device__ constexpr int toward_i(int o)
{
    if (DIRECTIONS == SPRINGS)
        return forward_i(o);
    return o < 2 ? o + 1 : (o - 2) % 5 - 2;
}

template <int DIRECTIONS>
static __host__ __device__ constexpr int toward_j(int o)
{
    return DIRECTIONS == SPRINGS ? forward_j(o) : (o + 3) / 5;
}

static __device__ inline bool within(struct grid g, int32_t i, int32_t j)
{
    return (uint32_t)i < (uint32_t)g.m && (uint32_t)j < (uint32_t)g.n;
}

/* A block, by words as wide as its place allows: fetch_once and store_once
 * where it is not needed again soon. */
#if defined __CUDACC__
#if REAL_BITS == 32
typedef float2 real2;
#else
typedef double2 real2;
#endif
static __device__ inline sym joined(real2 x, real2 y, real2 z)
{
    return sym{x.x, x.y, y.x, y.y, z.x, z.y};
}
static __device__ inline sym fetch(const sym *a)
{
    const real2 *b = (const real2 *)a;
    return joined(b[0], b[1], b[2]);
}
static __device__ inline sym fetch_once(const sym *a)
{
    const real2 *b = (const real2 *)a;
    return joined(__ldcs(b), __ldcs(b + 1), __ldcs(b + 2));
}
static __device__ inline vec fetch_once(const vec *a)
{
    return make(__ldcs(&a->x), __ldcs(&a->y), __ldcs(&a->z));
}
static __device__ inline void store_once(vec *to, vec a)
{
    __stcs(&to->x, a.x);
    __stcs(&to->y, a.y);
    __stcs(&to->z, a.z);
}
#else
struct real2 {
    real x, y;
};
static inline sym fetch(const sym *a)
{
    return *a;
}
static inline sym fetch_once(const sym *a)
{
    return *a;
}
static inline vec fetch_once(const vec *a)
{
    return *a;
}
static inline void store_once(vec *to, vec a)
{
    *to = a;
}
#endif

/* §3 of 11: where the blocks of the compressed diagonals are. */
static inline struct cdf cdf_of(int32_t m, int32_t n)
{
    int64_t count = (int64_t)m * n;
    struct cdf c = {{0}, {0}, count};
    for (int k = 1; k < DIAGONALS; k++) {
        int o = (k - 1) / 2;
        int64_t step = forward_i(o) + (int64_t)m * forward_j(o);
        bool forward = k % 2;
        c.offset[k] = forward ? step : -step;
        c.start[k] = forward ? c.blocks : c.blocks - step;
        c.blocks += step < count ? count - step : 0;
    }
    return c;
}

#endif
