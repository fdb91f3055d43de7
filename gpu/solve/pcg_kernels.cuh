/* SPDX-License-Identifier: Apache-2.0 */
/* The kernels of conjugate gradients other than products and multigrid cycles.
 * The last block of each takes the solver's state to the next phase.
 * spec/solve/pcg.md */
#ifndef GPU_PCG_KERNELS_CUH
#define GPU_PCG_KERNELS_CUH

#include "gpu/base/sum.cuh"
#include "gpu/cloth/rate.h"
#include "gpu/solve/pcg.cuh"
#include "gpu/solve/residual.cuh"

/* Scratch of a solve, and how M⁻¹r starts once r is known. */
struct scratch {
    real *chunk; /* [2·n_chunks] */
    real *item;  /* [count] */
    bool jacobi; /* M is Jacobi's, from the start or since multigrid gave up */
    struct opening opening;  /* multigrid's first smoothing, if !jacobi */
    const struct rate *rate; /* the matrix, unless NULL */
    int ring;                /* streams of directions: 1, 2 or RING */
    vec *p[RING];            /* [count] each; directions take turns */
};

/* Block k of these kernels owns chunk k of the particles, a thread each
 * particle; the block that ends last writes the next phase. UPDATES: the blocks
 * of the update kernel for each multiprocessor. */
enum { UPDATES = REAL_BITS == 32 ? 8 : 4 };

#define PARTICLE(k) int64_t k = (int64_t)blockIdx.x * SUM_CHUNK + threadIdx.x

/* One thread writes the solver's state at its beginning. scale and square are
 * the only numbers that change from one solve of a cloth to the next; no other
 * kernel reads them, so that a captured graph of all others stays valid. */
KERNEL pcg_open_kernel(struct pcg_state *c, real scale, real square)
{
    struct pcg_state fresh = {};
    fresh.from = scale;
    fresh.most = square;
    *c = fresh;
}

/* By Jacobi: s[k] = M⁻¹ r[k], and r[k]·s[k]. By multigrid: the first smoothing
 * of the cycle. */
static __device__ real begin_from(const struct pcg *s,
                                  const struct scratch *scratch, int k, vec r)
{
    if (!scratch->jacobi) {
        open_at(&scratch->opening, k, r);
        return 0;
    }
    vec z = solved(fetch_once(s->factor + k), r);
    s->s[k] = z;
    return dot(r, z);
}

/* §2: writes r[k]; reads dv and low of the neighbours, unless all are 0. */
KERNEL pcg_residual_kernel(const struct pcg &s, struct pcg_state *c,
                           const struct scratch &scratch)
{
    PARTICLE(k);
    int phase = c->phase;
    if (phase != PHASE_OPEN && phase != PHASE_ENDED)
        return;
    vec r = make(0, 0, 0);
    if (k < s.count) {
        bool zero = phase == PHASE_OPEN && !s.n_z;
        if (!s.fixed[k])
            r = zero ? s.b[k] : left_over(&s, place_of(grid{s.m, s.n}, k));
        s.r[k] = r;
        begin_from(&s, &scratch, (int)k, r);
    }
    real value = dot(r, r), sum;
    if (!grid_sums<1>(&value, scratch.chunk, &c->ticket, &sum) || threadIdx.x)
        return;
    if (phase == PHASE_OPEN)
        begin(&s, c, sum);
    else
        check_residual(&s, c, sum);
    c->waits = 0;
    c->again = c->phase != PHASE_DONE && (scratch.jacobi || !c->fell_back);
}

/* r·M⁻¹r by Jacobi after a restart, or after multigrid gave up; in later
 * iterations pcg_update_kernel computes it. */
KERNEL pcg_jacobi_kernel(const struct pcg &s, struct pcg_state *c,
                         const struct scratch &scratch)
{
    PARTICLE(k);
    if (!c->go || !c->fresh)
        return;
    real value = 0, sum;
    if (k < s.count)
        value = begin_from(&s, &scratch, (int)k, s.r[k]);
    if (grid_sums<1>(&value, scratch.chunk, &c->ticket, &sum) &&
        threadIdx.x == 0)
        enter(&s, c, sum);
}

/* The sum of item[k] of all particles: r·M⁻¹r by multigrid, or p·A p. */
KERNEL pcg_sum_kernel(const struct pcg &s, struct pcg_state *c,
                      const struct scratch &scratch, bool curvature)
{
    real sum;
    if (!c->go ||
        !item_sum(s.count, scratch.item, scratch.chunk, &c->ticket, &sum) ||
        threadIdx.x)
        return;
    if (curvature)
        measure(c, sum);
    else
        enter(&s, c, sum);
}

/* Updates dv + low of particle k by the steps that are outstanding, then by
 * alpha times p. */
static __device__ void move(const struct pcg *s, const struct pcg_state *c,
                            const struct scratch *scratch, int64_t k,
                            const vec *p, real alpha)
{
    vec x = fetch_once(s->dv + k), low = fetch_once(s->low + k);
    for (int e = 0, waits = c->waits; e < waits; e++)
        advance(&x, &low, scale(c->late[e], scratch->p[e][k]));
    if (p)
        advance(&x, &low, scale(alpha, p[k]));
    store_once(s->dv + k, x);
    store_once(s->low + k, low);
}

/* Writes dv[k], low[k], r[k] and the start of M⁻¹r. p: the direction of the
 * step; NULL: the update of dv and low is left to a later step, so that they
 * are read and written once for several steps. A block owns several chunks. */
KERNEL pcg_update_kernel(const struct pcg &s, struct pcg_state *c,
                         const struct scratch &scratch, const vec *p)
{
    real value[2], sum[2], alpha = c->alpha;
    if (!c->go)
        return;
    for (int64_t here = blockIdx.x; here < s.n_chunks; here += gridDim.x) {
        int64_t k = here * SUM_CHUNK + threadIdx.x;
        value[0] = value[1] = 0;
        if (k < s.count) {
            if (p && !s.fixed[k])
                move(&s, c, &scratch, k, p, alpha);
            vec r = axpy(s.r[k], -alpha, s.q[k]);
            s.r[k] = r;
            value[0] = dot(r, r);
            value[1] = begin_from(&s, &scratch, (int)k, r);
        }
        put_sums<2>(value, s.n_chunks, here, scratch.chunk);
    }
    if (!all_sums<2>(s.n_chunks, scratch.chunk, &c->ticket, sum) || threadIdx.x)
        return;
    if (!p)
        c->late[c->waits] = alpha;
    c->waits = p ? 0 : c->waits + 1;
    leave(&s, c, sum[0]);
    if (scratch.jacobi && c->go)
        enter(&s, c, sum[1]);
}

/* Updates dv and low by the steps that are outstanding when the iterations have
 * ended; the residual is next. */
KERNEL pcg_settle_kernel(const struct pcg &s, const struct pcg_state *c,
                         const struct scratch &scratch)
{
    ITEM(k, s.count);
    if (c->phase == PHASE_ENDED && c->waits && !s.fixed[k])
        move(&s, c, &scratch, k, NULL, 0);
}

#endif
