/* SPDX-License-Identifier: Apache-2.0 */
/* Adds to the block of each pair of particles what the odd cells and the stars
 * of a panel couple it by. spec/panel/joins.md */
#include "gpu/cloth/parts.cuh"
#include "gpu/panel/cell.cuh"

extern "C" {
#include "ref/panel/joins.h"
}

static __device__ sym plus(sym a, real w, sym b)
{
    return sym{a.xx + w * b.xx, a.xy + w * b.xy, a.xz + w * b.xz,
               a.yy + w * b.yy, a.yz + w * b.yz, a.zz + w * b.zz};
}

/* The corners of the pairs of a cell. */
static __device__ constexpr int start_of(int k)
{
    return k < 4 ? k : k - 4;
}
static __device__ constexpr int end_of(int k)
{
    return k < 4 ? (k + 1) % 4 : k - 2;
}

/* §1: the block of a fibre, of which d and q are as those of its cell. */
static __device__ sym fibre_block(const struct joins *s, const struct fibre *f,
                                  const struct law *law, vec d, vec q)
{
    struct parts a = spring_parts(law, s->piece, s->tau, d, q);
    a.b = f->weight * a.b;
    a.c = f->weight * max_of(a.c, R(0));
    return block_of(rate_of(&a));
}

/* §1. Thread k owns odd cell k: reads its corners and its fibres, and writes
 * the blocks of its six pairs. */
KERNEL joins_cells_kernel(const struct joins &s)
{
    ITEM(k, s.n_cells);
    struct beyond d = beyond_of(s.x, s.corner[k]), q = {};
    if (s.n_q)
        q = beyond_of(s.q, s.corner[k]);
    sym join[CELL_PAIRS] = {};
    for (int f = 0; f < FIBRES; f++) {
        struct fibre a = s.fibre[k][f];
        if (!(a.weight > 0))
            continue;
        real c[CORNERS] = {-((a.c[0] + a.c[1]) + a.c[2]), a.c[0], a.c[1],
                           a.c[2]};
        vec moves = s.n_q ? form_at(&a, &q) : make(0, 0, 0);
        sym b = fibre_block(&s, &a, &s.law[law_at(f)], form_at(&a, &d), moves);
        UNROLL
        for (int e = 0; e < CELL_PAIRS; e++)
            join[e] = plus(join[e], -(c[start_of(e)] * c[end_of(e)]), b);
    }
    UNROLL
    for (int e = 0; e < CELL_PAIRS; e++)
        s.join[CELL_PAIRS * k + e] = join[e];
}

/* §2. Thread k owns pair k of particles: adds to its block those of the odd
 * cells that have the pair, and that of the stars. The cells' must be complete.
 */
KERNEL joins_kernel(const struct joins &s)
{
    ITEM(k, s.n_pairs);
    sym *block = s.block + s.way[k] * s.count + s.first[k], a = *block;
    UNROLL
    for (int e = 0; e < 2; e++) {
        int at = s.from[k][e];
        if (at >= 0)
            a = add(a, s.join[at]);
    }
    real bend = s.tau * s.tau * s.bend[k];
    a.xx += bend;
    a.yy += bend;
    a.zz += bend;
    *block = a;
}

int gpu_joins(struct gpu *g, struct joins *s)
{
    LAUNCH(g, s->n_cells, joins_cells_kernel, *s);
    LAUNCH(g, s->n_pairs, joins_kernel, *s);
    return gpu_status(g);
}
