/* SPDX-License-Identifier: Apache-2.0 */
/* Drag, lift and resistance of each triangle, summed by its corners.
 * spec/cloth/wind.md */
#include "gpu/base/real.cuh"

extern "C" {
#include "ref/cloth/wind.h"
}

/* A thread block owns WIDE × HIGH particles and computes all cells with a
 * corner among them. */
enum {
    WIDE = 32,
    HIGH = 8,
    CELLS_WIDE = WIDE + 1,
    CELLS = CELLS_WIDE * (HIGH + 1)
};

namespace
{

/* The share of a corner in what a triangle has: force, N, and resistance,
 * kg/s. */
struct corner_load {
    vec force;
    real rate;
};

} // namespace

/* §1, §3: the share of a corner in the force on an area vector and in its
 * resistance. sum: of the velocities of all corners. */
static __device__ struct corner_load share_of(const struct wind *s, real share,
                                              vec area, vec sum)
{
    vec u = sub(s->air, scale(share, sum));
    real flow = dot(area, u), square = dot(u, u);
    real size = length(area) * root(square);
    if (!(size > 0))
        return {make(0, 0, 0), 0};
    real through = magnitude(flow);
    vec across = axpy(scale(square, area), -flow, u);
    vec f = scale(s->drag * through, u);
    f = axpy(f, s->lift * (flow / size), across);
    return {scale(share, f), share * ((s->drag + s->lift) * through)};
}

/* A third of the load of triangle abc. */
static __device__ struct corner_load third(const struct wind *s, int a, int b,
                                           int c)
{
    vec ab = sub(s->x[b], s->x[a]), ac = sub(s->x[c], s->x[a]);
    vec area = scale(R(0.5), cross(ab, ac));
    vec sum = add(add(s->v[a], s->v[b]), s->v[c]);
    return share_of(s, R(1.0 / 3), area, sum);
}

/* The shares of the two triangles of cell (i, j); 0 if the cell is not
 * present. */
static __device__ void fill_cell(const struct wind *s, int i, int j,
                                 struct corner_load part[2])
{
    part[0] = part[1] = {make(0, 0, 0), 0};
    if (i < 0 || j < 0 || i >= s->m || j >= s->n)
        return;
    int p = i + j * s->m, up = p + s->m;
    if (!s->cell[p])
        return;
    part[0] = third(s, p, p + 1, up + 1);
    part[1] = third(s, p, up + 1, up);
}

/* Adds a share to the sums of a particle. */
static __device__ void gain(struct corner_load *sum,
                            const struct corner_load &a)
{
    sum->force = add(sum->force, a.force);
    sum->rate += a.rate;
}

/* Thread t of a block computes cells t and t + 256 of its CELLS, then owns
 * particle (t % WIDE, t / WIDE) and writes the particle's force and inertia.
 * §2: the cells around a particle in ascending order. */
KERNEL wind_kernel(const struct wind &s, int across)
{
    __shared__ struct corner_load part[CELLS][2];
    int t = (int)threadIdx.x, block = (int)blockIdx.x;
    int row = block / across, column = block - row * across;
    int i0 = column * WIDE, j0 = row * HIGH;
    for (int c = t; c < CELLS; c += WIDE * HIGH)
        fill_cell(&s, i0 - 1 + c % CELLS_WIDE, j0 - 1 + c / CELLS_WIDE,
                  part[c]);
    __syncthreads();
    int i = i0 + t % WIDE, j = j0 + t / WIDE;
    if (i >= s.m || j >= s.n)
        return;
    struct corner_load(*here)[2] =
        part + (t / WIDE + 1) * CELLS_WIDE + t % WIDE + 1;
    struct corner_load(*below)[2] = here - CELLS_WIDE;
    struct corner_load sum = {make(0, 0, 0), 0};
    if (i > 0 && j > 0) {
        gain(&sum, below[-1][0]);
        gain(&sum, below[-1][1]);
    }
    if (j > 0)
        gain(&sum, below[0][1]);
    if (i > 0)
        gain(&sum, here[-1][0]);
    gain(&sum, here[0][0]);
    gain(&sum, here[0][1]);
    int p = i + j * s.m;
    s.force[p] = sum.force;
    if (s.n_inertia)
        s.inertia[p] = s.mass[p] + s.tau * sum.rate;
}

/* §4. Thread k owns odd cell k: reads its corners and writes what each gets. */
KERNEL wind_cells_kernel(const struct wind &s)
{
    ITEM(k, s.n_cells);
    const int32_t *at = s.corner[k];
    int a = at[0], b = at[1], c = at[2], d = at[3];
    vec area = scale(R(0.5), cross(sub(s.x[c], s.x[a]), sub(s.x[d], s.x[b])));
    vec sum = add(add(s.v[a], s.v[b]), s.v[c]);
    if (d != a)
        sum = add(sum, s.v[d]);
    struct corner_load got =
        share_of(&s, d == a ? R(1.0 / 3) : R(0.25), area, sum);
    s.load[k][0] = got.force;
    s.load[k][1] = make(got.rate, 0, 0);
}

/* §4. Thread k owns particle owner[k]: adds what its odd cells have for it, in
 * ascending order. The loads must be complete. */
KERNEL wind_odd_kernel(const struct wind &s)
{
    ITEM(k, s.n_parts);
    int p = s.owner[k];
    struct corner_load sum = {s.force[p], 0};
    UNROLL
    for (int e = 0; e < 4; e++) {
        int at = s.push[k][e];
        if (at >= 0)
            gain(&sum, {s.load[(uint32_t)at >> 2][0],
                        s.load[(uint32_t)at >> 2][1].x});
    }
    s.force[p] = sum.force;
    if (s.n_inertia)
        s.inertia[p] += s.tau * sum.rate;
}

int gpu_wind(struct gpu *g, struct wind *s)
{
    int across = s->m / WIDE + (s->m % WIDE > 0);
    int64_t down = s->n / HIGH + (s->n % HIGH > 0);
    LAUNCH_BLOCKS(g, down * across, WIDE * HIGH, wind_kernel, *s, across);
    if (s->n_cells > 0) {
        LAUNCH(g, s->n_cells, wind_cells_kernel, *s);
        LAUNCH(g, s->n_parts, wind_odd_kernel, *s);
    }
    return gpu_status(g);
}
