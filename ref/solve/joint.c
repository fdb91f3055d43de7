/* SPDX-License-Identifier: Apache-2.0 */
/* Conjugate gradients over all cloths and their contacts; each cloth's own
 * preconditioner takes its part. spec/contact/penalty.md §4 */
#include "ref/solve/joint.h"

#include "ref/base/sum.h"
#include "ref/sleep/sleep.h"
#include "ref/solve/jacobi.h"
#include "ref/solve/product.h"
#include "ref/world/state.h"

static const real LAST_PART = R(2.0) / 3; /* of the last step, by Jacobi */

/* The system of one cloth: its solver with hold as `extra`, on its part of the
 * joint residual. Only its preconditioner is used. */
static struct pcg part_of(const struct sheet *s, const struct joint *a)
{
    struct pcg p = s->solver.pcg;
    p.block = s->dynamics.block;
    p.thin = s->dynamics.thin;
    p.n_extra = p.count;
    p.extra = a->hold + s->first;
    p.r = a->r + s->first;
    p.n_z = 0;
    return p;
}

static int set_up(struct world *w, struct joint *a)
{
    int status = DRAPE_OK;
    for (int k = 0; k < w->def.n_cloths && status == DRAPE_OK; k++) {
        struct pcg p = part_of(&w->sheet[k], a);
        if (!sleep_awake(w, k))
            continue;
        status = pcg_open(&p);
        if (status == DRAPE_OK)
            status = ref_pcg_set_up(&p);
    }
    return status;
}

static real dot(struct joint *a, const vec *x, const vec *y)
{
    struct dot d = {a->nc, x, y, a->n_chunks, a->chunk, 0};
    ref_dot(&d);
    return d.value;
}

/* Sets q to M⁻¹ r, cloth by cloth, and returns r·q. */
static real precondition(struct world *w, struct joint *a)
{
    for (int k = 0; k < w->def.n_cloths; k++) {
        struct pcg p = part_of(&w->sheet[k], a);
        if (!sleep_awake(w, k))
            continue;
        pcg_open(&p);
        vec *z = a->q + w->sheet[k].first;
        if (p.precond == DRAPE_MULTIGRID)
            ref_multigrid_cycle(&p.grid);
        EACH_ITEM
        for (int64_t i = 0; i < p.count; i++)
            z[i] = p.precond == DRAPE_MULTIGRID
                       ? p.s[i]
                       : factor_solve(p.factor[i], p.r[i]);
    }
    return dot(a, a->r, a->q);
}

/* y = A x, or (A + wall) x, 0 where fixed. */
static void multiply(struct world *w, const struct joint *a, bool with_walls,
                     const vec *x, vec *y)
{
    for (int k = 0; k < w->def.n_cloths; k++) {
        const struct sheet *s = &w->sheet[k];
        const struct pcg *p = &s->solver.pcg;
        if (!sleep_awake(w, k))
            continue;
        struct product m = {.m = p->m,
                            .n = p->n,
                            .count = p->count,
                            .mass = p->mass,
                            .n_extra = with_walls ? p->count : 0,
                            .extra = a->wall + s->first,
                            .n_blocks = p->n_cdf ? 0 : p->n_blocks,
                            .block = s->dynamics.block,
                            .n_cdf = p->n_cdf,
                            .cdf = p->cdf,
                            .x = x + s->first,
                            .y = y + s->first};
        ref_product(&m);
    }
    EACH_ITEM
    for (int64_t i = 0; i < a->nc; i++)
        if (!(w->w[i] > 0))
            y[i] = vec_make(0, 0, 0);
}

/* y gains the contacts' matrix times x. */
static void add_links(struct joint *a, const vec *x, vec *y)
{
    a->links.x = x;
    a->links.y = y;
    ref_links(&a->links);
}

/* Sets q to (A + wall + C) p and returns p·q. */
static real curvature_of(struct world *w, struct joint *a)
{
    multiply(w, a, true, a->p, a->q);
    add_links(a, a->p, a->q);
    return dot(a, a->p, a->q);
}

/* dv += α p, r -= α q; where α is 0 p may not be finite. */
static void move(struct joint *a, real alpha)
{
    int64_t n = alpha != 0 ? a->nc : 0;
    EACH_ITEM
    for (int64_t i = 0; i < n; i++) {
        a->dv[i] = vec_axpy(a->dv[i], alpha, a->p[i]);
        a->r[i] = vec_axpy(a->r[i], -alpha, a->q[i]);
    }
    a->iterations++;
}

/* p = M⁻¹ r + β p, and a step along p; the first direction has before = 0.
 * False if the matrix is not positive definite along p. */
static bool step(struct world *w, struct joint *a, real next, real before)
{
    real beta = before > 0 ? next / before : 0;
    EACH_ITEM
    for (int64_t i = 0; i < a->nc; i++)
        a->p[i] = before > 0 ? vec_axpy(a->q[i], beta, a->p[i]) : a->q[i];
    real curvature = curvature_of(w, a);
    if (!pcg_positive(curvature))
        return false;
    move(a, next / curvature);
    return true;
}

/* §4.5: a step along the solution of the slice before. None if the solution is
 * 0 or a product with it overflows. */
static void recall(struct world *w, struct joint *a)
{
    EACH_ITEM
    for (int64_t i = 0; i < a->nc; i++)
        a->p[i] = a->last[i];
    real curvature = curvature_of(w, a), along = dot(a, a->p, a->r);
    real alpha = pcg_positive(curvature) ? along / curvature : 0;
    move(a, alpha - alpha == 0 ? alpha : 0);
}

/* pcg.md §4.1: whether r·M⁻¹r and |r|² have fallen below the tolerance. */
static bool calm(const struct joint *a, real next, real square)
{
    return next == 0 || (real_sqrt(next / a->scale) <= a->tolerance &&
                         real_sqrt(square / a->square) <= a->exact);
}

static int iterate(struct world *w, struct joint *a)
{
    real before = 0;
    if (a->last) {
        if (a->weigh)
            a->scale = real_max(precondition(w, a), a->scale);
        recall(w, a);
    }
    while (a->iterations < a->max_iterations) {
        real square = dot(a, a->r, a->r), next = precondition(w, a);
        if (!(before > 0))
            a->scale = real_max(next, a->scale);
        if (calm(a, next, square))
            return PCG_CONVERGED;
        if (!pcg_positive(next) || !step(w, a, next, before))
            return PCG_BREAKDOWN;
        before = next;
    }
    return PCG_LIMIT;
}

/* §4.2: a last step along M⁻¹ r, which the test of the tolerance has left in
 * q. */
static void improve(const struct world *w, struct joint *a)
{
    bool jacobi = w->sheet[0].solver.pcg.precond == DRAPE_JACOBI;
    real part = jacobi ? LAST_PART : 1;
    EACH_ITEM
    for (int64_t i = 0; i < a->nc; i++)
        a->dv[i] = vec_axpy(a->dv[i], part, a->q[i]);
}

/* Sets q to A dv without contacts, and finds the true residual, which counts
 * them: b - A dv - wall dv - C dv. */
static void conclude(struct world *w, struct joint *a)
{
    multiply(w, a, false, a->dv, a->q);
    EACH_ITEM
    for (int64_t i = 0; i < a->nc; i++)
        a->p[i] = sym_apply(a->wall[i], a->dv[i]);
    add_links(a, a->dv, a->p);
    EACH_ITEM
    for (int64_t i = 0; i < a->nc; i++)
        a->r[i] = vec_sub(vec_sub(a->b[i], a->q[i]), a->p[i]);
    a->residual = real_sqrt(dot(a, a->r, a->r) / a->square);
}

int joint_solve(struct world *w, struct joint *a)
{
    a->iterations = 0;
    a->residual = 0;
    a->outcome = PCG_CONVERGED;
    EACH_ITEM
    for (int64_t i = 0; i < a->links.nv; i++) {
        a->r[i] = i < a->nc ? a->b[i] : vec_make(0, 0, 0);
        a->dv[i] = a->p[i] = vec_make(0, 0, 0);
    }
    int status = set_up(w, a);
    real square = dot(a, a->r, a->r);
    a->square = real_max(square, a->square);
    if (status != DRAPE_OK || square == 0)
        return status;
    a->outcome = pcg_positive(square) ? iterate(w, a) : PCG_BREAKDOWN;
    if (a->outcome == PCG_CONVERGED && a->iterations > 0)
        improve(w, a);
    conclude(w, a);
    return DRAPE_OK;
}
