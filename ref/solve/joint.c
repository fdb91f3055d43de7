/* SPDX-License-Identifier: Apache-2.0 */
/* Conjugate gradients over all cloths and their contacts; each cloth's own
 * preconditioner takes its part. spec/contact/lagrange.md §3.2 */
#include "ref/solve/joint.h"

#include "ref/base/sum.h"
#include "ref/sleep/sleep.h"
#include "ref/solve/product.h"
#include "ref/solve/sewn.h"
#include "ref/world/state.h"

/* The system of one cloth: its solver with bound as `extra`, on its part of the
 * joint residual. Only its preconditioner is used. */
static struct pcg part_of(const struct sheet *s, const struct joint *a)
{
    struct pcg p = s->solver.pcg;
    p.block = s->dynamics.block;
    p.packed = s->dynamics.packed;
    p.n_extra = p.count;
    p.extra = a->bound + s->first;
    p.r = a->r + s->first;
    p.n_z = 0;
    return p;
}

/* The cloths, as the cycle with seams takes them. */
static struct sewn *put_cloths(struct world *w, struct joint *a)
{
    for (int k = 0; k < w->def.n_cloths; k++) {
        struct pcg p = part_of(&w->sheet[k], a);
        p.s = a->q + w->sheet[k].first;
        pcg_open(&p);
        ref_sewn_put(w->seams.grids, k, &p.grid, sleep_awake(w, k));
    }
    return w->seams.grids;
}

int ref_joint_set_up(struct world *w, struct joint *a)
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
    if (status == DRAPE_OK && w->seams.grids)
        ref_sewn_set_up(put_cloths(w, a));
    return status;
}

static real dot_streams(struct joint *a, const vec *x, const vec *y)
{
    struct dot d = {
        .n = a->nc, .a = x, .b = y, .n_chunks = a->n_chunks, .chunk = a->chunk};
    ref_dot(&d);
    return d.value;
}

/* Sets q to M⁻¹ r, cloth by cloth, and returns r·q. */
static real apply_preconditioner(struct world *w, struct joint *a)
{
    if (w->seams.grids)
        ref_sewn_cycle(put_cloths(w, a));
    for (int k = 0; k < w->def.n_cloths && !w->seams.grids; k++) {
        struct pcg p = part_of(&w->sheet[k], a);
        if (!sleep_awake(w, k))
            continue;
        p.s = a->q + w->sheet[k].first;
        pcg_open(&p);
        pcg_precondition(&p);
    }
    return dot_streams(a, a->r, a->q);
}

/* y = A x, or (A + single) x, 0 where fixed. */
static void multiply_matrix(struct world *w, const struct joint *a,
                            bool with_singles, const vec *x, vec *y)
{
    for (int k = 0; k < w->def.n_cloths; k++) {
        const struct sheet *s = &w->sheet[k];
        const struct pcg *p = &s->solver.pcg;
        if (!sleep_awake(w, k))
            continue;
        struct product m = pcg_product(p, x + s->first, y + s->first);
        m.n_extra = with_singles ? p->count : 0;
        m.extra = a->single + s->first;
        m.block = s->dynamics.block;
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

/* Sets q to (A + single + C) p and returns p·q. */
static real curvature_of(struct world *w, struct joint *a)
{
    multiply_matrix(w, a, true, a->p, a->q);
    add_links(a, a->p, a->q);
    return dot_streams(a, a->p, a->q);
}

/* dv += α p, r -= α q; where α is 0 p may not be finite. */
static void move_solution(struct joint *a, real alpha)
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
static bool step_along(struct world *w, struct joint *a, real next, real before)
{
    real beta = before > 0 ? next / before : 0;
    EACH_ITEM
    for (int64_t i = 0; i < a->nc; i++)
        a->p[i] = before > 0 ? vec_axpy(a->q[i], beta, a->p[i]) : a->q[i];
    real curvature = curvature_of(w, a);
    if (!pcg_positive(curvature))
        return false;
    move_solution(a, next / curvature);
    return true;
}

/* The start of a solve: no motion, the residual is b. */
static void take_residual(struct joint *a, const vec *b)
{
    EACH_ITEM
    for (int64_t i = 0; i < a->links.nv; i++) {
        vec none = vec_make(0, 0, 0);
        a->r[i] = i < a->nc ? b[i] : none;
        a->dv[i] = a->p[i] = none;
    }
}

int ref_joint_measure(struct world *w, struct joint *a, const vec *r,
                      real *value)
{
    take_residual(a, r);
    *value = apply_preconditioner(w, a);
    return DRAPE_OK;
}

static int iterate_gradients(struct world *w, struct joint *a)
{
    real before = 0, first = 0;
    while (a->iterations < a->max_iterations) {
        real next = apply_preconditioner(w, a);
        first = a->iterations == 0 ? next : first;
        if (next == 0 || real_sqrt(next / first) <= a->tolerance)
            return PCG_CONVERGED;
        if (!pcg_positive(next) || !step_along(w, a, next, before))
            return PCG_BREAKDOWN;
        before = next;
    }
    return PCG_LIMIT;
}

/* §3.2: a last step along M⁻¹ r, which the test of the tolerance has left in
 * q. */
static void improve_solution(const struct world *w, struct joint *a)
{
    bool jacobi = w->sheet[0].solver.pcg.precond == DRAPE_JACOBI;
    real part = jacobi ? JOINT_LAST_PART : 1;
    EACH_ITEM
    for (int64_t i = 0; i < a->nc; i++)
        a->dv[i] = vec_axpy(a->dv[i], part, a->q[i]);
}

int ref_joint_solve(struct world *w, struct joint *a)
{
    a->iterations = 0;
    take_residual(a, a->b);
    a->outcome = iterate_gradients(w, a);
    if (a->outcome == PCG_CONVERGED && a->iterations > 0)
        improve_solution(w, a);
    multiply_matrix(w, a, false, a->dv, a->q);
    return DRAPE_OK;
}
