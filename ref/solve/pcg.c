/* SPDX-License-Identifier: Apache-2.0 */
/* Preconditioned conjugate gradients. spec/solve/pcg.md */
#include "ref/solve/pcg.h"

#include "ref/base/sum.h"
#include "ref/solve/jacobi.h"
#include "ref/solve/product.h"

int64_t ref_pcg_size(struct pcg *s)
{
    s->count = (int64_t)s->m * s->n;
    s->n_blocks = SPRINGS * s->count;
    bool thin = s->precond == DRAPE_MULTIGRID && !s->whole;
    s->n_packed = thin ? s->n_blocks : 0;
    s->n_chunks = sum_chunks(s->count);
    s->n_cdf = s->form == DRAPE_CDF ? ref_cdf(s->m, s->n).blocks : 0;
    struct multigrid none = {0};
    s->grid = none;
    if (s->precond == DRAPE_MULTIGRID) {
        s->grid.depth = s->depth;
        s->grid.m = s->m;
        s->grid.n = s->n;
        s->grid.n_packed = s->n_packed;
    }
    return ref_multigrid_size(&s->grid) + s->n_cdf * (int64_t)sizeof(mat) +
           s->count * (int64_t)(2 * sizeof(sym) + 5 * sizeof(vec)) +
           s->n_chunks * (int64_t)sizeof(real);
}

static real dot_streams(struct pcg *s, const vec *a, const vec *b)
{
    struct dot d = {.n = s->count,
                    .a = a,
                    .b = b,
                    .n_chunks = s->n_chunks,
                    .chunk = s->chunk};
    ref_dot(&d);
    return d.value;
}

struct product pcg_product(const struct pcg *s, const vec *x, vec *y)
{
    struct product a = {.m = s->m,
                        .n = s->n,
                        .count = s->count,
                        .mass = s->mass,
                        .n_extra = s->n_extra,
                        .extra = s->extra,
                        .n_blocks = s->n_cdf ? 0 : s->n_blocks,
                        .block = s->block,
                        .n_cdf = s->n_cdf,
                        .cdf = s->cdf,
                        .x = x,
                        .y = y};
    return a;
}

static void multiply_matrix(struct pcg *s, const vec *x, vec *y)
{
    struct product a = pcg_product(s, x, y);
    ref_product(&a);
}

void pcg_precondition(struct pcg *s)
{
    if (s->precond == DRAPE_MULTIGRID && !s->fell_back) {
        ref_multigrid_cycle(&s->grid);
        return;
    }
    EACH_ITEM
    for (int64_t k = 0; k < s->count; k++)
        s->s[k] = factor_solve(s->factor[k], s->r[k]);
}

/* §2: sets r to the residual for dv = low = 0: b, and 0 where fixed. */
static void take_right_side(struct pcg *s)
{
    EACH_ITEM
    for (int64_t k = 0; k < s->count; k++)
        s->r[k] = s->fixed[k] ? vec_make(0, 0, 0) : s->b[k];
}

/* TwoSum (Knuth): *a becomes *a + b, rounded; returns the rounding error,
 * exactly.
 */
static real two_sum(real *a, real b)
{
    real sum = *a + b, part = sum - *a;
    real error = (*a - (sum - part)) + (b - part);
    *a = sum;
    return error;
}

/* §3: adds alpha p to dv + low. */
static void advance_solution(vec *dv, vec *low, real alpha, vec p)
{
    vec d = vec_scale(alpha, p);
    low->x += two_sum(&dv->x, d.x);
    low->y += two_sum(&dv->y, d.y);
    low->z += two_sum(&dv->z, d.z);
}

/* Gives multigrid the streams that it shares with the solve. */
static void set_up_grid(struct pcg *s)
{
    s->grid.mass = s->mass;
    s->grid.n_extra = s->n_extra;
    s->grid.extra = s->extra;
    s->grid.block = s->block;
    s->grid.n_packed = s->n_packed;
    s->grid.packed = s->packed;
    s->grid.triples = s->triples;
    s->grid.fixed = s->fixed;
    s->grid.factor = s->factor;
    s->grid.r = s->r;
    s->grid.z = s->s;
}

int pcg_open(struct pcg *s)
{
    if (s->n_chunks != sum_chunks(s->count) || !(s->tolerance >= 0) ||
        s->max_iterations < 0 || (s->n_z && s->n_z != s->count) ||
        s->precond < DRAPE_JACOBI || s->precond > DRAPE_MULTIGRID ||
        s->form < DRAPE_CDF || s->form > DRAPE_COMPACT)
        return DRAPE_EARG;
    set_up_grid(s);
    s->iterations = s->fell_back = 0;
    s->recurrence = s->residual = 0;
    s->outcome = PCG_CONVERGED;
    return DRAPE_OK;
}

int pcg_set_up(struct pcg *s, const struct pcg_stages *stages, void *backend)
{
    struct matrix a = {.m = s->m,
                       .n = s->n,
                       .count = s->count,
                       .mass = s->mass,
                       .n_extra = s->n_extra,
                       .extra = s->extra,
                       .n_blocks = s->n_blocks,
                       .block = s->block,
                       .n_cdf = s->n_cdf,
                       .diagonal = s->diagonal,
                       .cdf = s->cdf};
    struct jacobi j = {.m = s->m,
                       .n = s->n,
                       .count = s->count,
                       .mass = s->mass,
                       .n_extra = s->n_extra,
                       .extra = s->extra,
                       .n_blocks = s->n_blocks,
                       .block = s->block,
                       .n_packed = s->n_packed,
                       .packed = s->packed,
                       .fixed = s->fixed,
                       .factor = s->factor};
    int status = s->n_cdf ? stages->matrix(backend, &a) : DRAPE_OK;
    if (status == DRAPE_OK)
        status = stages->jacobi(backend, &j);
    if (status == DRAPE_OK && s->precond == DRAPE_MULTIGRID)
        status = stages->multigrid(backend, &s->grid);
    return status;
}

static int run_matrix(void *none, struct matrix *s)
{
    (void)none;
    return ref_matrix(s);
}

static int run_jacobi(void *none, struct jacobi *s)
{
    (void)none;
    return ref_jacobi(s);
}

static int run_multigrid(void *none, struct multigrid *s)
{
    (void)none;
    return ref_multigrid_build(s);
}

int ref_pcg_set_up(struct pcg *s)
{
    static const struct pcg_stages stages = {run_matrix, run_jacobi,
                                             run_multigrid};
    return pcg_set_up(s, &stages, NULL);
}

/* §1: makes the matrix and M, and sets the start of dv. */
static int set_up(struct pcg *s)
{
    int status = ref_pcg_set_up(s);
    EACH_ITEM
    for (int64_t k = 0; k < s->count; k++) {
        s->dv[k] = s->fixed[k] && s->n_z ? s->z[k] : vec_make(0, 0, 0);
        s->low[k] = vec_make(0, 0, 0);
    }
    return status;
}

/* §3: makes the next direction p from s = M⁻¹ r, where next = r·s, and its
 * image q, and takes a step along p. False if the matrix is not positive
 * definite along p. */
static bool step_along(struct pcg *s, real next, real *rho, bool first)
{
    real beta = first ? 0 : next / *rho;
    *rho = next;
    EACH_ITEM
    for (int64_t k = 0; k < s->count; k++)
        s->p[k] = first ? s->s[k] : vec_axpy(s->s[k], beta, s->p[k]);

    multiply_matrix(s, s->p, s->q);
    EACH_ITEM
    for (int64_t k = 0; k < s->count; k++)
        if (s->fixed[k])
            s->q[k] = vec_make(0, 0, 0);
    real curvature = dot_streams(s, s->p, s->q);
    if (!pcg_positive(curvature))
        return false;
    real alpha = next / curvature;
    EACH_ITEM
    for (int64_t k = 0; k < s->count; k++) {
        if (!s->fixed[k])
            advance_solution(&s->dv[k], &s->low[k], alpha, s->p[k]);
        s->r[k] = vec_axpy(s->r[k], -alpha, s->q[k]);
    }
    return true;
}

/* §4.1: whether r·M⁻¹r and |r|² have fallen below the tolerance. */
static bool has_converged(struct pcg *s, real next, real square)
{
    if (s->iterations == 0)
        s->scale = real_max(next, s->scale);
    s->recurrence = real_sqrt(next / s->scale);
    return next == 0 || (s->recurrence <= s->tolerance &&
                         real_sqrt(square / s->square) <= s->tolerance);
}

/* §4: iterates until the recurrence meets the tolerance; returns the outcome.
 */
static int iterate_gradients(struct pcg *s, real square)
{
    real rho = 0, left = square;
    for (bool first = true; s->iterations < s->max_iterations; first = false) {
        pcg_precondition(s);
        real next = dot_streams(s, s->r, s->s);
        if (s->energy && has_converged(s, next, left))
            return PCG_CONVERGED;
        if (!pcg_positive(next) || !step_along(s, next, &rho, first))
            return PCG_BREAKDOWN;
        s->iterations++;
        left = dot_streams(s, s->r, s->r);
        if (s->energy)
            continue;
        s->recurrence = real_sqrt(left / square);
        if (!(s->recurrence > s->tolerance))
            return s->recurrence <= s->tolerance ? PCG_CONVERGED
                                                 : PCG_BREAKDOWN;
    }
    return PCG_LIMIT;
}

int ref_pcg(struct pcg *s)
{
    int status = pcg_open(s);
    if (status == DRAPE_OK)
        status = set_up(s);
    if (status != DRAPE_OK)
        return status;

    if (s->n_z)
        residual_find(s);
    else
        take_right_side(s);
    real square = dot_streams(s, s->r, s->r), before = 2;
    if (square == 0)
        return DRAPE_OK;
    s->recurrence = s->residual = 1;
    real most = square;
    if (s->energy)
        most = s->square = real_max(square, s->square);
    if (!pcg_positive(square))
        s->outcome = PCG_BREAKDOWN;
    /* §4: restarts from the true residual, as long as each restart at least
     * halves it. */
    while (s->outcome == PCG_CONVERGED && !(s->residual <= s->tolerance)) {
        if (!(s->residual <= before / 2)) {
            s->outcome = PCG_STALLED;
            break;
        }
        before = s->residual;
        s->outcome = iterate_gradients(s, square);
        residual_find(s);
        s->residual = real_sqrt(dot_streams(s, s->r, s->r) / most);
        if (s->energy && s->outcome == PCG_CONVERGED)
            break;
        /* §5: after a breakdown of multigrid Jacobi may still converge. */
        if (s->outcome == PCG_BREAKDOWN && s->residual - s->residual == 0 &&
            s->precond == DRAPE_MULTIGRID && !s->fell_back) {
            s->fell_back = 1;
            s->outcome = PCG_CONVERGED;
            before = 2 * s->residual;
        }
    }
    return DRAPE_OK;
}
