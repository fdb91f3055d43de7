/* SPDX-License-Identifier: Apache-2.0 */
/* The paper's solver, for comparison: ref_pcg with the vector operations of
 * cuBLAS, whose sums have an order of their own. spec/solve/pcg.md §6 */
#include "gpu/compare/blas.h"
#include "gpu/solve/pcg.cuh"
#include "gpu/solve/residual.cuh"
#include "gpu/solve/sweep.cuh"

/* Kernels for operations that cuBLAS does not have: A, M⁻¹, the true residual,
 * TwoSum. */

/* Thread k owns r[k]; reads dv and low of the neighbours. §2 */
KERNEL cublas_residual_kernel(const struct pcg &s)
{
    ITEM(k, s.count);
    s.r[k] =
        s.fixed[k] ? make(0, 0, 0) : left_over(&s, place_of(grid{s.m, s.n}, k));
}

/* Thread k owns s[k] = M⁻¹r by Jacobi. */
KERNEL cublas_jacobi_kernel(const struct pcg &s)
{
    ITEM(k, s.count);
    s.s[k] = solved(s.factor[k], s.r[k]);
}

/* Thread k owns particle k: the first smoothing of multigrid's cycle from r[k].
 */
KERNEL cublas_open_kernel(const struct opening &o, int64_t count, const vec *r)
{
    ITEM(k, count);
    open_at(&o, (int)k, r[k]);
}

/* Thread k owns dv[k] and low[k]. */
KERNEL cublas_advance_kernel(const struct pcg &s, real alpha)
{
    ITEM(k, s.count);
    if (!s.fixed[k])
        advance(&s.dv[k], &s.low[k], scale(alpha, s.p[k]));
}

/* q = A x, 0 where fixed. */
struct filtered {
    const uint8_t *fixed;
    vec *q;
};

static __device__ bool about(const struct filtered *e, struct place at)
{
    return e->fixed[at.p];
}

static __device__ void arrive(const struct filtered *e, struct place at,
                              bool fixed, vec x, vec y)
{
    (void)x;
    e->q[at.p] = fixed ? make(0, 0, 0) : y;
}

KERNEL cublas_product_kernel(const struct product &a, const struct cdf &d,
                             const struct filtered &e)
{
    ITEM(k, a.count);
    struct place at = place_of(grid{a.m, a.n}, k);
    arrive(&e, at, about(&e, at), a.x[k], cdf_row(&a, &d, at));
}

static real dotted(struct gpu *g, const struct pcg *s, const vec *a,
                   const vec *b)
{
    return (real)blas_dot(g, REAL_BITS, 3 * s->count, a, b);
}

static void precondition(struct gpu *g, struct pcg *s)
{
    if (s->precond == DRAPE_JACOBI || s->fell_back) {
        LAUNCH(g, s->count, cublas_jacobi_kernel, *s);
        return;
    }
    LAUNCH(g, s->count, cublas_open_kernel, gpu_multigrid_opening(&s->grid),
           s->count, s->r);
    gpu_multigrid_cycle(g, &s->grid, lent_by(s), NULL, NULL);
}

static void multiply(struct gpu *g, struct pcg *s)
{
    struct filtered e = {s->fixed, s->q};
    edges<sym> t = {
        {s->m, s->n}, s->mass, s->n_extra ? s->extra : NULL, NULL, s->block};
    struct product a = pcg_product(s, s->p, s->q);
    if (s->n_cdf)
        LAUNCH(g, s->count, cublas_product_kernel, a, cdf_of(s->m, s->n), e);
    else
        product_of<SPRINGS>(g, t, plain{s->p}, e, NULL);
}

static bool sound(real a)
{
    return a > 0 && a - a == 0;
}

static real size_of(real square)
{
    return (real)sqrt((double)square);
}

static real larger(real a, real b)
{
    return a > b ? a : b;
}

/* §3: a step along the direction from s = M⁻¹r, next = r·s. */
static bool step(struct gpu *g, struct pcg *s, real next, real *rho, bool first)
{
    int64_t n = 3 * s->count;
    if (first)
        gpu_copy(g, s->p, s->s, (size_t)s->count * sizeof *s->p);
    else {
        blas_scale(g, REAL_BITS, n, (double)(next / *rho), s->p);
        blas_add(g, REAL_BITS, n, 1, s->s, s->p);
    }
    *rho = next;
    multiply(g, s);
    real curvature = dotted(g, s, s->p, s->q);
    if (!sound(curvature))
        return false;
    real alpha = next / curvature;
    LAUNCH(g, s->count, cublas_advance_kernel, *s, alpha);
    blas_add(g, REAL_BITS, n, (double)-alpha, s->q, s->r);
    return true;
}

/* §4, §4.1: iterates until the recurrence meets the tolerance. */
static int iterate(struct gpu *g, struct pcg *s, real square)
{
    real rho = 0, left = square;
    for (bool first = true; s->iterations < s->max_iterations; first = false) {
        precondition(g, s);
        real next = dotted(g, s, s->r, s->s);
        if (s->energy) {
            s->scale = s->iterations ? s->scale : larger(next, s->scale);
            s->recurrence = size_of(next / s->scale);
            bool converged = s->recurrence <= s->tolerance &&
                             size_of(left / s->square) <= s->tolerance;
            if (next == 0 || converged)
                return PCG_CONVERGED;
        }
        if (!sound(next) || !step(g, s, next, &rho, first))
            return PCG_BREAKDOWN;
        s->iterations++;
        left = dotted(g, s, s->r, s->r);
        if (s->energy)
            continue;
        s->recurrence = size_of(left / square);
        if (!(s->recurrence > s->tolerance))
            return s->recurrence <= s->tolerance ? PCG_CONVERGED
                                                 : PCG_BREAKDOWN;
    }
    return PCG_LIMIT;
}

/* The true residual's square. */
static real remain(struct gpu *g, struct pcg *s)
{
    LAUNCH(g, s->count, cublas_residual_kernel, *s);
    return dotted(g, s, s->r, s->r);
}

static void solve(struct gpu *g, struct pcg *s)
{
    real square = remain(g, s), before = 2;
    if (square == 0)
        return;
    s->recurrence = s->residual = 1;
    real most = square;
    if (s->energy)
        most = s->square = larger(square, s->square);
    if (!sound(square))
        s->outcome = PCG_BREAKDOWN;
    while (s->outcome == PCG_CONVERGED && !(s->residual <= s->tolerance)) {
        if (!(s->residual <= before / 2)) {
            s->outcome = PCG_STALLED;
            break;
        }
        before = s->residual;
        s->outcome = iterate(g, s, square);
        s->residual = size_of(remain(g, s) / most);
        if (s->energy && s->outcome == PCG_CONVERGED)
            break;
        if (s->outcome == PCG_BREAKDOWN && s->residual - s->residual == 0 &&
            s->precond == DRAPE_MULTIGRID && !s->fell_back) {
            s->fell_back = 1;
            s->outcome = PCG_CONVERGED;
            before = 2 * s->residual;
        }
    }
}

int gpu_pcg_compare(struct gpu *g, struct pcg *s)
{
    int status = blas_open(g);
    if (status == DRAPE_OK)
        status = gpu_pcg_set_up(g, s);
    if (status == DRAPE_OK && s->count > 0)
        solve(g, s);
    gpu_read_back(g, 0); /* brings the late words, as gpu_pcg does */
    return status == DRAPE_OK ? gpu_status(g) : status;
}
