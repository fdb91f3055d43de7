/* SPDX-License-Identifier: Apache-2.0 */
/* Conjugate gradients over all cloths and their contacts; each cloth's own
 * preconditioner takes its part. spec/contact/lagrange.md §3.2 */
#include "ref/solve/joint.h"

#include "ref/base/sum.h"
#include "ref/base/threads.h"
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

/* What is done with all cloths that are awake. */
struct cloth_part {
    struct world *w;
    const struct joint *a;
    void (*part)(struct cloth_part *p, const struct sheet *s);
    const vec *x; /* [nc] of a product */
    vec *y;
    bool with_singles;
    atomic_int status; /* of those that failed */
};

static void run_cloth(void *user, int k)
{
    struct cloth_part *p = user;
    if (sleep_awake(p->w, k))
        p->part(p, &p->w->sheet[k]);
}

static int each_cloth(struct cloth_part *p)
{
    const struct world *w = p->w;
    int64_t most = 0, all = 0;
    for (int k = 0; k < w->def.n_cloths; k++) {
        int64_t n = sleep_awake(w, k) ? w->sheet[k].cloth.count : 0;
        most = n > most ? n : most;
        all += n;
    }
    threads_each(w->def.n_cloths, threads_spread(most, all), run_cloth, p);
    return atomic_load(&p->status);
}

static void set_up_cloth(struct cloth_part *p, const struct sheet *s)
{
    struct pcg m = part_of(s, p->a);
    int status = pcg_open(&m);
    status = status == DRAPE_OK ? ref_pcg_set_up(&m) : status;
    if (status != DRAPE_OK)
        atomic_store(&p->status, status);
}

int ref_joint_set_up(struct world *w, struct joint *a)
{
    struct cloth_part p = {.w = w, .a = a, .part = set_up_cloth};
    int status = each_cloth(&p);
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

static void precondition_cloth(struct cloth_part *p, const struct sheet *s)
{
    struct pcg m = part_of(s, p->a);
    m.s = p->y + s->first;
    pcg_open(&m);
    pcg_precondition(&m);
}

/* Sets q to M⁻¹ r, cloth by cloth, and returns r·q. */
static real apply_preconditioner(struct world *w, struct joint *a)
{
    struct cloth_part p = {
        .w = w, .a = a, .part = precondition_cloth, .y = a->q};
    if (w->seams.grids)
        ref_sewn_cycle(put_cloths(w, a));
    else
        each_cloth(&p);
    return dot_streams(a, a->r, a->q);
}

static void multiply_cloth(struct cloth_part *p, const struct sheet *s)
{
    const struct pcg *a = &s->solver.pcg;
    struct product m = pcg_product(a, p->x + s->first, p->y + s->first);
    m.n_extra = p->with_singles ? a->count : 0;
    m.extra = p->a->single + s->first;
    m.block = s->dynamics.block;
    ref_product(&m);
}

/* y = A x, or (A + single) x, 0 where fixed. */
static void multiply_matrix(struct world *w, const struct joint *a,
                            bool with_singles, const vec *x, vec *y)
{
    struct cloth_part p = {.w = w,
                           .a = a,
                           .part = multiply_cloth,
                           .x = x,
                           .y = y,
                           .with_singles = with_singles};
    each_cloth(&p);
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
