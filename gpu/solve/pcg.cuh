/* SPDX-License-Identifier: Apache-2.0 */
/* The scalars of conjugate gradients, which stay on the device: who moves
 * from where to where in ref_pcg, one thread at a time. spec/solve/pcg.md §3–§5
 */
#ifndef GPU_PCG_CUH
#define GPU_PCG_CUH

#include "gpu/solve/level.cuh"
#include "ref/solve/pcg.h"

/* What is to be done next: the first residual, an iteration, the residual
 * after the last one, nothing. */
enum phase { PHASE_OPEN, PHASE_ITERATE, PHASE_ENDED, PHASE_DONE };

/* Directions that are kept at most, and that many steps moved at once. */
enum { RING = 8 };

/* Lies in gpu_words. Every kernel of the solver reads it first and
 * does nothing out of its phase: so any number of iterations may be queued. */
struct course {
    unsigned ticket; /* of grid_sums */
    int32_t phase;   /* enum phase */
    int32_t go;      /* 1: phase is PHASE_ITERATE */
    int32_t first;   /* 1: no direction yet */
    int32_t fresh;   /* 1: M⁻¹ r is not known yet */
    int32_t again;   /* 1: more of the same, 0: the host is to look */
    int32_t outcome; /* enum pcg_outcome */
    int32_t iterations, fell_back;
    int32_t waits; /* steps by which dv has yet to move, of RING */
    real late[RING - 1];
    real square, most;       /* |r|² at first, what residual is relative to */
    real left, before, from; /* |r|² as it goes, residual, scale */
    real rho, alpha, beta;
    real recurrence, residual;
};

static __device__ inline bool positive(real a)
{
    return a > 0 && a - a == 0;
}

static __device__ inline void end(struct course *c, int outcome)
{
    c->outcome = outcome;
    c->phase = PHASE_ENDED;
    c->go = 0;
}

/* The head of ref_pcg's outer loop. */
static __device__ inline void restart(const struct pcg *s, struct course *c)
{
    c->phase = PHASE_DONE;
    if (c->outcome != PCG_CONVERGED || c->residual <= s->tolerance)
        return;
    if (!(c->residual <= c->before / 2)) {
        c->outcome = PCG_STALLED;
        return;
    }
    c->before = c->residual;
    c->rho = 0;
    c->left = c->square;
    c->first = c->fresh = c->go = 1;
    c->phase = PHASE_ITERATE;
    if (c->iterations >= s->max_iterations)
        end(c, PCG_LIMIT);
}

/* square: |b - A z|². */
static __device__ inline void begin(const struct pcg *s, struct course *c,
                                    real square)
{
    c->square = square;
    c->most = s->energy ? most(square, c->most) : square;
    c->before = 2;
    c->outcome = PCG_CONVERGED;
    c->phase = PHASE_DONE;
    if (square == 0)
        return;
    c->recurrence = c->residual = 1;
    if (!positive(square))
        c->outcome = PCG_BREAKDOWN;
    restart(s, c);
}

/* square: of the residual after the last iteration. */
static __device__ inline void judge(const struct pcg *s, struct course *c,
                                    real square)
{
    c->residual = root(square / c->most);
    c->phase = PHASE_DONE;
    if (s->energy && c->outcome == PCG_CONVERGED)
        return;
    if (c->outcome == PCG_BREAKDOWN && c->residual - c->residual == 0 &&
        s->precond == DRAPE_MULTIGRID && !c->fell_back) {
        c->fell_back = 1;
        c->outcome = PCG_CONVERGED;
        c->before = 2 * c->residual;
    }
    restart(s, c);
}

/* next: r·M⁻¹r, whence the next direction. */
static __device__ inline void enter(const struct pcg *s, struct course *c,
                                    real next)
{
    c->fresh = 0;
    if (s->energy) {
        if (c->iterations == 0)
            c->from = most(next, c->from);
        c->recurrence = root(next / c->from);
        bool near = c->recurrence <= s->tolerance &&
                    root(c->left / c->most) <= s->tolerance;
        if (next == 0 || near) {
            end(c, PCG_CONVERGED);
            return;
        }
    }
    if (!positive(next)) {
        end(c, PCG_BREAKDOWN);
        return;
    }
    c->beta = c->first ? 0 : next / c->rho;
    c->rho = next;
}

/* curvature: p·A p. */
static __device__ inline void measure(struct course *c, real curvature)
{
    if (!positive(curvature))
        end(c, PCG_BREAKDOWN);
    else
        c->alpha = c->rho / curvature;
}

/* square: |r|² after a step. */
static __device__ inline void leave(const struct pcg *s, struct course *c,
                                    real square)
{
    c->iterations++;
    c->first = 0;
    c->left = square;
    if (!s->energy) {
        c->recurrence = root(square / c->square);
        if (!(c->recurrence > s->tolerance)) {
            end(c,
                c->recurrence <= s->tolerance ? PCG_CONVERGED : PCG_BREAKDOWN);
            return;
        }
    }
    if (c->iterations >= s->max_iterations)
        end(c, PCG_LIMIT);
}

/* ---- vectors ---- */

/* *a + b rounded to *a; what is rounded off, exactly (Knuth). */
static __device__ inline real two_sum(real *a, real b)
{
    real sum = *a + b, part = sum - *a;
    real error = (*a - (sum - part)) + (b - part);
    *a = sum;
    return error;
}

/* §3: x + low += d. */
static __device__ inline void advance(vec *x, vec *low, vec d)
{
    low->x += two_sum(&x->x, d.x);
    low->y += two_sum(&x->y, d.y);
    low->z += two_sum(&x->z, d.z);
}

/* A world's p and q lie one behind the other, before a stream [count] that has
 * no use while there is a solve. */
static inline bool lies_before(const struct pcg *s)
{
    return s->q == s->p + s->count;
}

/* What the search has no use for while M is built or applied. */
static inline struct lent lent_by(const struct pcg *s)
{
    return lies_before(s) ? lent{(sym *)s->p, s->q} : lent{};
}

/* The matrix and its preconditioner; dv and low as they start. DRAPE_OK, or
 * DRAPE_EARG as ref_pcg. */
int gpu_pcg_set_up(struct gpu *g, struct pcg *s);

/* §6: gpu_pcg behind pcg_open, by the solver of gpu/compare. DRAPE_EDEVICE
 * where its library is not there. */
int gpu_pcg_compare(struct gpu *g, struct pcg *s);

#endif
