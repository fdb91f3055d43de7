/* SPDX-License-Identifier: Apache-2.0 */
/* The scalars of conjugate gradients, which stay on the device, and the
 * functions that one thread calls, at the end of a kernel, to take the solver
 * to the next phase of ref_pcg. spec/solve/pcg.md §3–§5 */
#ifndef GPU_PCG_CUH
#define GPU_PCG_CUH

#include "gpu/solve/level.cuh"

extern "C" {
#include "ref/solve/pcg.h"
}

/* What comes next: the first residual, an iteration, the true residual after
 * the last iteration, nothing. */
enum phase { PHASE_OPEN, PHASE_ITERATE, PHASE_ENDED, PHASE_DONE };

/* The most directions that are kept, so that one update of dv can add that many
 * steps. */
enum { RING = 8 };

/* The state of a solve, in gpu_words. Every kernel of the solver reads it first
 * and does nothing if it is not the kernel's phase, so that any number of
 * iterations may be queued. */
struct pcg_state {
    unsigned ticket; /* for ends_last of the sums */
    int32_t phase;   /* enum phase */
    int32_t go;      /* 1 if phase is PHASE_ITERATE */
    int32_t first;   /* 1: there is no direction since the (re)start */
    int32_t fresh;   /* 1: r·M⁻¹r of the current r is not known yet */
    int32_t again;   /* 1: another chunk; 0: the host decides */
    int32_t outcome; /* enum pcg_outcome */
    int32_t iterations, fell_back;
    int32_t waits;           /* steps that have not been added to dv yet */
    real late[RING - 1];     /* their alphas */
    real square, most;       /* the first |r|²; the |r|² that `residual` is
                                relative to */
    real left, before, from; /* |r|² by the recurrence; the last true residual;
                                the r·M⁻¹r that the tolerance is relative to */
    real rho, alpha, beta;
    real recurrence, residual;
};

static __device__ inline bool positive(real a)
{
    return a > 0 && a - a == 0;
}

static __device__ inline void end(struct pcg_state *c, int outcome)
{
    c->outcome = outcome;
    c->phase = PHASE_ENDED;
    c->go = 0;
}

/* Decides whether to restart, as the condition of ref_pcg's outer loop does,
 * and prepares the iterations that follow. */
static __device__ inline void restart(const struct pcg *s, struct pcg_state *c)
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

/* Called after the first residual. square: |b - A z|². */
static __device__ inline void begin(const struct pcg *s, struct pcg_state *c,
                                    real square)
{
    c->square = square;
    c->most = s->energy ? max_of(square, c->most) : square;
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

/* Called after the true residual that follows the last iteration. square: |r|².
 */
static __device__ inline void check_residual(const struct pcg *s,
                                             struct pcg_state *c, real square)
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

/* Called after the preconditioner. next: r·M⁻¹r, which gives β. */
static __device__ inline void enter(const struct pcg *s, struct pcg_state *c,
                                    real next)
{
    c->fresh = 0;
    if (s->energy) {
        if (c->first && !c->fell_back)
            c->from = max_of(next, c->from);
        c->recurrence = root(next / c->from);
        bool converged = c->recurrence <= s->tolerance &&
                         root(c->left / c->most) <= s->tolerance;
        if (next == 0 || converged) {
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

/* Called after the product. curvature: p·A p, which gives α. */
static __device__ inline void measure(struct pcg_state *c, real curvature)
{
    if (!positive(curvature))
        end(c, PCG_BREAKDOWN);
    else
        c->alpha = c->rho / curvature;
}

/* Called after a step along p. square: |r|². */
static __device__ inline void leave(const struct pcg *s, struct pcg_state *c,
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

/* TwoSum (Knuth): *a becomes *a + b, rounded; returns the rounding error,
 * exactly. */
static __device__ inline real two_sum(real *a, real b)
{
    real sum = *a + b, part = sum - *a;
    real error = (*a - (sum - part)) + (b - part);
    *a = sum;
    return error;
}

/* §3: adds d to x + low. */
static __device__ inline void advance(vec *x, vec *low, vec d)
{
    low->x += two_sum(&x->x, d.x);
    low->y += two_sum(&x->y, d.y);
    low->z += two_sum(&x->z, d.z);
}

/* Whether q follows p in memory, as in a world. There a stream [count] that is
 * unused during a solve follows q. */
static inline bool lies_before(const struct pcg *s)
{
    return s->q == s->p + s->count;
}

/* The stream that multigrid may use while M is built, as p and q are idle then;
 * or NULL. */
static inline sym *lent_by(const struct pcg *s)
{
    return lies_before(s) ? (sym *)s->p : NULL;
}

/* Queues the matrix and its preconditioner M. Returns the status of these
 * stages. */
int gpu_pcg_prepare(struct gpu *g, struct pcg *s);
/* Queues them, and the start of dv and low. Likewise. */
int gpu_pcg_set_up(struct gpu *g, struct pcg *s);

/* §6: solves with cuBLAS, in gpu/compare, after pcg_open. DRAPE_EDEVICE if the
 * library is not there. */
int gpu_pcg_compare(struct gpu *g, struct pcg *s);

/* §3: queues the next direction `to` = s + β p, with β of c, its image q = A
 * to, and item[k] = to[k]·q[k]. The kernels do nothing if c->go is 0. */
struct search {
    struct pcg_state *c;
    const struct rate *rate; /* the matrix, unless NULL */
    const vec *p;
    vec *to;
    real *item;
};
void gpu_pcg_search(struct gpu *g, const struct pcg *s, struct search a);
/* Whether that product sweeps (gpu/solve/sweep.cuh). */
bool gpu_pcg_sweeps(const struct pcg *s);

#endif
