/* SPDX-License-Identifier: Apache-2.0 */
/* Computes the 3 × 3 block of each pair of particles that a spring or a triple
 * couples. spec/cloth/blocks.md */
#include "gpu/base/packed.cuh"
#include "gpu/cloth/cloth.cuh"
#include "gpu/cloth/parts.cuh"

enum { SIX = sizeof(sym) / sizeof(real) };

/* §7: the spring's share of its block, and that of the triples that have their
 * middle at one of its ends; cells: about these ends. */
static __device__ struct parts with_triples(const struct blocks *s, int o,
                                            struct parts a, int p, int q)
{
    const real *triple = s->triple + CELL_MASKS * o;
    int here = s->beside[p], there = s->beside[q];
    real fraction = spring_fraction(o, here), square = s->tau * s->tau;
    a.b = fraction * a.b + 2 * square * (triple[here] + triple[there]);
    a.c *= fraction;
    return a;
}

/* x, q: position and predicted motion of p. */
static __device__ struct parts parts_of(const struct blocks *s, int o, int p,
                                        vec x, vec q)
{
    int end = p + forward_i(o) + forward_j(o) * s->m;
    if (s->triples && o >= SPRINGS_SINGLE) { /* of a triple, end to end */
        int single = o % SPRINGS_SINGLE;
        int at = p + forward_i(single) + forward_j(single) * s->m;
        real k = s->triple[CELL_MASKS * single + s->beside[at]];
        return parts{-(s->tau * s->tau * k), 0, make(0, 0, 0)};
    }
    vec moves = s->n_q ? sub(s->q[end], q) : make(0, 0, 0);
    struct parts a =
        spring_parts(&s->law[o], s->piece, s->tau, sub(s->x[end], x), moves);
    return s->triples ? with_triples(s, o, a, p, end) : a;
}

/* Thread t of block k owns particle 256 k + t: reads the particle and the far
 * ends of its forward springs. The thread block collects the blocks of one
 * direction in shared memory, so that the writes are coalesced. rate: NULL if
 * no rates are wanted. */
KERNEL blocks_kernel(const struct blocks &a, struct rate *rate)
{
    __shared__ sym s[GPU_BLOCK];
    int t = (int)threadIdx.x, base = (int)blockIdx.x * GPU_BLOCK, p = base + t;
    int n = (int)a.count - base;
    int reals = SIX * (n < GPU_BLOCK ? n : GPU_BLOCK);
    int mask = t < n ? a.springs[p] : 0;
    vec x = t < n ? a.x[p] : make(0, 0, 0);
    vec q = t < n && a.n_q ? a.q[p] : make(0, 0, 0);
    UNROLL
    for (int o = 0; o < SPRINGS; o++) {
        struct parts b = {0, 0, make(0, 0, 0)};
        if (mask >> o & 1)
            b = parts_of(&a, o, p, x, q);
        struct rate r = rate_of(&b);
        s[t] = block_of(r);
        if (a.n_packed && t < n)
            a.packed[o * a.count + p] = packed_of(b.c, b.b, b.u);
        if (rate && t < n)
            rate[o * a.count + p] = r;
        __syncthreads();
        real *to = (real *)(a.block + o * a.count + base);
        for (int r = t; r < reals; r += GPU_BLOCK)
            to[r] = ((const real *)s)[r];
        __syncthreads();
    }
}

int gpu_blocks_and_rates(struct gpu *g, const struct blocks *s,
                         struct rate *rate)
{
    int64_t blocks = (s->count + GPU_BLOCK - 1) / GPU_BLOCK;
    LAUNCH_BLOCKS(g, blocks, GPU_BLOCK, blocks_kernel, *s, rate);
    return gpu_status(g);
}

int gpu_blocks(struct gpu *g, struct blocks *s)
{
    return gpu_blocks_and_rates(g, s, NULL);
}
