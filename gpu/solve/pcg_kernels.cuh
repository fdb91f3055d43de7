/* SPDX-License-Identifier: Apache-2.0 */
/* The kernels of conjugate gradients between products and cycles, which move
 * the course on. spec/solve/pcg.md */
#ifndef GPU_PCG_KERNELS_CUH
#define GPU_PCG_KERNELS_CUH

#include "gpu/base/sum.cuh"
#include "gpu/cloth/rate.h"
#include "gpu/solve/pcg.cuh"
#include "gpu/solve/residual.cuh"

/* Scratch of its own, and how M⁻¹r begins once r is known. */
struct room {
    real *chunk;            /* [2·n_chunks] */
    real *item;             /* [count] */
    bool jacobi;            /* M is Jacobi's, by now or from the start */
    struct opening opening; /* else */
    struct rates rates;     /* of: NULL, or the matrix is read from them */
    int ring;               /* 1, 2 or RING */
    vec *p[RING];           /* [count] the last of them, by turns */
};

/* Of these kernels block k owns chunk k of the particles, a thread a particle;
 * the block that ends last moves the course on. Of an update there are UPDATES
 * blocks at most on a multiprocessor. */
enum { UPDATES = REAL_BITS == 32 ? 8 : 4 };

#define PARTICLE(k) int64_t k = (int64_t)blockIdx.x * SUM_CHUNK + threadIdx.x

/* One thread writes the solver's state at its beginning. scale and square are
 * the only numbers that change from one solve of a cloth to the next; no other
 * kernel reads them, so that a captured graph of all others stays valid. */
static __global__ void pcg_open_kernel(struct course *c, real scale,
                                       real square)
{
    struct course fresh = {};
    fresh.from = scale;
    fresh.most = square;
    *c = fresh;
}

/* Writes dv[k] and low[k]. §1 */
static __global__ void __launch_bounds__(GPU_BLOCK)
    pcg_start_kernel(struct pcg s)
{
    ITEM(k, s.count);
    s.dv[k] = s.fixed[k] && s.n_z ? s.z[k] : make(0, 0, 0);
    s.low[k] = make(0, 0, 0);
}

/* s[k] = M⁻¹r by Jacobi, and r·s; or the first half-step of multigrid. */
static __device__ real begin_from(const struct pcg *s, const struct room *room,
                                  int k, vec r)
{
    if (!room->jacobi) {
        open_at(&room->opening, k, r);
        return 0;
    }
    vec z = solved(fetch_once(s->factor + k), r);
    s->s[k] = z;
    return dot(r, z);
}

/* Writes r[k]; reads dv and low of the neighbours, unless all are 0. §2 */
static __global__ void __launch_bounds__(SUM_CHUNK)
    pcg_residual_kernel(struct pcg s, struct course *c, struct room room)
{
    PARTICLE(k);
    int phase = c->phase;
    if (phase != PHASE_OPEN && phase != PHASE_ENDED)
        return;
    struct residual a = {s.m,     s.n,     s.count, s.mass, s.n_extra, s.extra,
                         s.block, s.fixed, s.b,     s.dv,   s.low,     s.r};
    vec r = make(0, 0, 0);
    if (k < s.count) {
        bool zero = phase == PHASE_OPEN && !s.n_z;
        if (!s.fixed[k])
            r = zero ? s.b[k] : left_over(&a, place_of(grid{s.m, s.n}, k));
        s.r[k] = r;
        begin_from(&s, &room, (int)k, r);
    }
    real value = dot(r, r), sum;
    if (!grid_sums<1>(&value, room.chunk, &c->ticket, &sum) || threadIdx.x)
        return;
    if (phase == PHASE_OPEN)
        begin(&s, c, sum);
    else
        judge(&s, c, sum);
    c->waits = 0;
    c->again = c->phase != PHASE_DONE && (room.jacobi || !c->fell_back);
}

/* r·M⁻¹r by Jacobi after a restart, or where multigrid gave up; later it is
 * pcg_update_kernel's. */
static __global__ void __launch_bounds__(SUM_CHUNK)
    pcg_jacobi_kernel(struct pcg s, struct course *c, struct room room)
{
    PARTICLE(k);
    if (!c->go || !c->fresh)
        return;
    real value = 0, sum;
    if (k < s.count)
        value = begin_from(&s, &room, (int)k, s.r[k]);
    if (grid_sums<1>(&value, room.chunk, &c->ticket, &sum) && threadIdx.x == 0)
        enter(&s, c, sum);
}

/* The sum of item[k] of all particles: r·M⁻¹r by multigrid, or p·A p. */
static __global__ void __launch_bounds__(SUM_CHUNK)
    pcg_sum_kernel(struct pcg s, struct course *c, struct room room,
                   bool curvature)
{
    real sum;
    if (!c->go || !item_sum(s.count, room.item, room.chunk, &c->ticket, &sum) ||
        threadIdx.x)
        return;
    if (curvature)
        measure(c, sum);
    else
        enter(&s, c, sum);
}

/* dv + low of particle k by the steps that wait, and by `alpha` times p. */
static __device__ void move(const struct pcg *s, const struct course *c,
                            const struct room *room, int64_t k, const vec *p,
                            real alpha)
{
    vec x = fetch_once(s->dv + k), low = fetch_once(s->low + k);
    for (int e = 0, waits = c->waits; e < waits; e++)
        advance(&x, &low, scale(c->late[e], room->p[e][k]));
    if (p)
        advance(&x, &low, scale(alpha, p[k]));
    store_once(s->dv + k, x);
    store_once(s->low + k, low);
}

/* Writes dv[k], low[k], r[k] and what starts from r[k]; p of the step, NULL
 * where it waits for a later one, so that dv and low are touched once for all.
 * A block takes turns at chunks. */
static __global__ void __launch_bounds__(SUM_CHUNK, UPDATES)
    pcg_update_kernel(struct pcg s, struct course *c, struct room room,
                      const vec *p)
{
    real value[2], sum[2], alpha = c->alpha;
    if (!c->go)
        return;
    for (int64_t here = blockIdx.x; here < s.n_chunks; here += gridDim.x) {
        int64_t k = here * SUM_CHUNK + threadIdx.x;
        value[0] = value[1] = 0;
        if (k < s.count) {
            if (p && !s.fixed[k])
                move(&s, c, &room, k, p, alpha);
            vec r = axpy(s.r[k], -alpha, s.q[k]);
            s.r[k] = r;
            value[0] = dot(r, r);
            value[1] = begin_from(&s, &room, (int)k, r);
        }
        put_sums<2>(value, s.n_chunks, here, room.chunk);
    }
    if (!all_sums<2>(s.n_chunks, room.chunk, &c->ticket, sum) || threadIdx.x)
        return;
    if (!p)
        c->late[c->waits] = alpha;
    c->waits = p ? 0 : c->waits + 1;
    leave(&s, c, sum[0]);
    if (room.jacobi && c->go)
        enter(&s, c, sum[1]);
}

/* The steps that wait when iterations have ended; the residual is next. */
static __global__ void __launch_bounds__(GPU_BLOCK)
    pcg_settle_kernel(struct pcg s, const struct course *c, struct room room)
{
    ITEM(k, s.count);
    if (c->phase == PHASE_ENDED && c->waits && !s.fixed[k])
        move(&s, c, &room, k, NULL, 0);
}

#endif
