/* SPDX-License-Identifier: Apache-2.0 */
/* Stage jacobi on the device: the block-Jacobi preconditioner.
 * spec/solve/jacobi.md */
#include "gpu/solve/jacobi.cuh"

#include "gpu/base/packed.cuh"
#include "gpu/run/merge.cuh"
#include "gpu/solve/grid.cuh"

/* The number of directions whose blocks are read before the first is added. */
enum { AHEAD = 4 };

/* Adds the packed block t. Its products are exact, as in ref/solve/jacobi.h. */
static __device__ struct wide_sym add(struct wide_sym d, struct packed t)
{
    struct packed_parts a = opened(t);
    double x = (double)a.e.x, y = (double)a.e.y, z = (double)a.e.z;
    double s = (double)a.size, all = (double)a.all;
    double sx = s * x, sy = s * y, sz = s * z;
    return wide_sym{{d.a[0] + (sx * x + all), d.a[1] + sx * y, d.a[2] + sx * z,
                     d.a[3] + (sy * y + all), d.a[4] + sy * z,
                     d.a[5] + (sz * z + all)}};
}

/* Thread p owns particle p: it reads mass, extra and the blocks of its edges in
 * `from`, and writes factor[p]. */
template <class B> KERNEL jacobi_kernel(const struct jacobi &s, const B *from)
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
    UNROLL
    for (int first = 0; first < SPRINGS; first += AHEAD) {
        B block[2 * AHEAD];
        bool good[2 * AHEAD];
        UNROLL
        for (int k = 0; k < 2 * AHEAD; k++) {
            int o = first + k / 2, sign = k % 2 ? -1 : 1;
            int di = forward_i(o), dj = forward_j(o);
            good[k] = within(g, at.i + sign * di, at.j + sign * dj);
            int p = good[k] && k % 2 ? at.p - (di + s.m * dj) : at.p;
            block[k] = fetch(from + o * s.count + p);
        }
        UNROLL
        for (int k = 0; k < 2 * AHEAD; k++)
            d = good[k] ? add(d, block[k]) : d;
    }
    s.factor[at.p] = factored(d);
}

int gpu_jacobi(struct gpu *g, struct jacobi *s)
{
    if (s->n_packed)
        MERGE(g, s->count, (*s, s->packed), jacobi_kernel<struct packed>);
    else
        MERGE(g, s->count, (*s, s->block), jacobi_kernel<sym>);
    return gpu_status(g);
}
