/* SPDX-License-Identifier: Apache-2.0 */
/* Loops over prescribed vertices and over displacements on the device.
 * spec/world/step.md §1, §6, §7, §11 */
#include "gpu/base/largest.cuh"
#include "gpu/base/real.cuh"

extern "C" {
#include "gpu/run/backend.h"
#include "gpu/world/state.h"
#include "ref/base/prescribed.h"
}

/* Thread k owns pin k and writes the place of its particle. */
KERNEL pins_kernel(int64_t n, const int32_t *pinned, const vec *x, vec *to)
{
    ITEM(k, n);
    to[pinned[k]] = x[k];
}

void gpu_prescribed_pin(struct gpu *g, int64_t n, const int32_t *pinned,
                        const vec *x, vec *to)
{
    LAUNCH(g, n, pins_kernel, n, pinned, x, to);
}

static __device__ bool same_bits(const vec *a, const vec *b)
{
    real_bits p[3], q[3];
    memcpy(p, a, sizeof p);
    memcpy(q, b, sizeof q);
    return p[0] == q[0] && p[1] == q[1] && p[2] == q[2];
}

/* Thread k owns obstacle vertex k, or pin k, and sets *moves if its place
 * changes. */
KERNEL moves_kernel(int64_t n, const int32_t *at, const vec *x0, const vec *x1,
                    int64_t *moves)
{
    ITEM(k, n);
    if (!same_bits(&x0[at ? at[k] : k], &x1[k]))
        *moves = 1; /* all threads that write, write the same */
}

bool gpu_prescribed_moves(const struct world *w)
{
    struct gpu *g = w->device->gpu;
    int64_t *moves = gpu_words(g);
    LAUNCH(g, w->nv - w->nc, moves_kernel, w->nv - w->nc, nullptr,
           w->x0 + w->nc, w->x1 + w->nc, moves);
    for (int k = 0; k < w->def.n_cloths; k++) {
        struct pins pins = sheet_pins(&w->sheet[k]);
        LAUNCH(g, pins.n, moves_kernel, pins.n, pins.at,
               w->x0 + w->sheet[k].first, pins.x, moves);
    }
    return gpu_read_back(g, 1)[0] != 0;
}

bool gpu_prescribed_differs(struct gpu *g, int64_t n, const int32_t *at,
                            const vec *x0, const vec *x1)
{
    int64_t *moves = gpu_words(g);
    LAUNCH(g, n, moves_kernel, n, at, x0, x1, moves);
    return gpu_read_back(g, 1)[0] != 0;
}

static __device__ real interpolate(real a, real b, double part)
{
    double from = (double)a;
    return (real)(from + part * ((double)b - from));
}

/* Thread i owns item i and writes x[i]. */
KERNEL blend_kernel(const struct blend &s)
{
    ITEM(i, s.n);
    int64_t k = s.at ? s.at[i] : i;
    vec a = s.from[k], b = s.to[k];
    if (s.part < 1)
        b = make(interpolate(a.x, b.x, s.part), interpolate(a.y, b.y, s.part),
                 interpolate(a.z, b.z, s.part));
    s.x[i] = b;
}

void gpu_prescribed_blend(struct gpu *g, const struct blend *s)
{
    LAUNCH(g, s->n, blend_kernel, *s);
}

/* Thread i owns particle i and puts a[i] back where the particle is fixed. */
KERNEL keep_kernel(int64_t n, const uint8_t *fixed, const vec *old, vec *a)
{
    ITEM(i, n);
    if (fixed[i])
        a[i] = old[i];
}

void gpu_prescribed_keep(struct gpu *g, int64_t n, const uint8_t *fixed,
                         const vec *old, vec *a)
{
    LAUNCH(g, n, keep_kernel, n, fixed, old, a);
}

/* Thread i owns item i and sets *bad if a[i] is out of range. */
KERNEL sane_kernel(int64_t n, const vec *a, int64_t *bad)
{
    ITEM(i, n);
    if (!sane(a[i]))
        *bad = 1; /* all threads that write, write the same */
}

bool gpu_prescribed_sane(struct gpu *g, int64_t n, const vec *a)
{
    int64_t *bad = gpu_words(g);
    LAUNCH(g, n, sane_kernel, n, a, bad);
    return gpu_read_back(g, 1)[0] == 0;
}

/* Thread k owns vertex k and writes v[k]. */
KERNEL velocities_kernel(int64_t n, const vec *x0, const vec *x1, real dt,
                         vec *v)
{
    ITEM(k, n);
    vec d = sub(x1[k], x0[k]);
    v[k] = make(d.x / dt, d.y / dt, d.z / dt);
}

void gpu_prescribed_velocities(struct gpu *g, int64_t n, const vec *x0,
                               const vec *x1, real dt, vec *v)
{
    LAUNCH(g, n, velocities_kernel, n, x0, x1, dt, v);
}

/* Thread i owns vertex i and computes the square of its displacement, m². Each
 * block makes one atomic maximum. */
KERNEL way_kernel(int64_t n, const vec *x0, const vec *x1, int64_t *most)
{
    int64_t i = (int64_t)blockIdx.x * GPU_BLOCK + threadIdx.x;
    vec d = i < n ? sub(x1[i], x0[i]) : make(0, 0, 0);
    block_largest(most, dot(d, d));
}

real gpu_prescribed_furthest(struct gpu *g, int64_t n, const vec *x0,
                             const vec *x1)
{
    int64_t *most = gpu_words(g);
    LAUNCH_BLOCKS(g, largest_blocks(n), GPU_BLOCK, way_kernel, n, x0, x1, most);
    return largest_of(gpu_read_back(g, 1));
}

/* Thread k owns triangle k and writes 1 if it belongs to cloth, else 0. */
KERNEL group_kernel(int64_t nt, int64_t cloths, int32_t *group)
{
    ITEM(k, nt);
    group[k] = k < cloths;
}

int gpu_ending_streams(struct gpu *g, struct audit *s, int64_t nt,
                       int64_t cloths)
{
    LAUNCH(g, nt, group_kernel, nt, cloths, (int32_t *)s->group);
    return gpu_status(g);
}
