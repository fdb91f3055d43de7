/* SPDX-License-Identifier: Apache-2.0 */
/* Contacts within the implicit solve of every cloth. spec/contact/penalty.md §4
 */
#include "ref/contact/couple.h"

#include "ref/base/clock.h"
#include "ref/contact/warm.h"
#include "ref/world/state.h"

enum { TURNS = 2 }; /* of the first contacts of a slice; later ones: 1 */
static const real ROUGH = R(0.1); /* tolerance of a motion before contact */

static void *take(struct world *w, int64_t n, size_t size)
{
    return arena_take(w->arena, ARENA_RESPONSE, n, size);
}

int couple_make(struct world *w)
{
    struct couple *c = &w->couple;
    struct penalty *p = &c->penalty;
    p->nv = w->nv;
    p->nv1 = w->nv + 1;
    p->w = w->w;
    p->u = w->response.u;
    p->stiffness = w->response.stiffness;
    p->start = w->response.start;
    p->force = take(w, w->nv, sizeof *p->force);
    p->hold = take(w, w->nv, sizeof *p->hold);
    p->guess = take(w, w->nv, sizeof *p->guess);
    c->press = p->guess; /* which nobody reads between two penalties */
    p->brake = take(w, w->nv, sizeof *p->brake);
    c->g = take(w, w->nc, sizeof *c->g);
    p->g = c->g;
    c->b = take(w, w->nc, sizeof *c->b);
    c->dv = take(w, w->nc, sizeof *c->dv);
    return w->arena->failed ? DRAPE_ENOMEM : DRAPE_OK;
}

bool couple_prepare(const struct world *w, struct pcg *p)
{
    bool rough =
        w->near == NEAR_CONTACTS && w->plan.implicit && !w->plan.history;
    real asked = (real)w->def.tolerance;
    p->energy = rough;
    p->tolerance = rough ? real_max(asked, ROUGH) : asked;
    p->scale = p->square = 0;
    return rough;
}

void couple_start(struct world *w)
{
    struct couple *c = &w->couple;
    struct penalty *p = &c->penalty;
    bool past = w->plan.history && state_has_past(w);
    p->dt = w->response.dt;
    p->slip = real_min(R(1e-3), R(0.01) * w->reach / p->dt);
    p->tau = (real)(past ? w->dt * 2 / 3 : w->dt);
    c->iterations = c->solves = c->outcome = 0;
    c->residual = 0;
    c->seconds = 0;
    bool warm = state_warm(w);
    EACH_ITEM
    for (int64_t i = 0; i < w->nc; i++)
        c->g[i] = warm ? vec_scale(p->dt, w->press[i]) : vec_make(0, 0, 0);
}

static int make_room(struct world *w, int64_t n)
{
    struct couple *c = &w->couple;
    struct penalty *p = &c->penalty;
    if (n <= c->cap)
        return DRAPE_OK;
    arena_give(w->arena, p->item);
    arena_give(w->arena, p->vertex);
    arena_give(w->arena, p->share);
    arena_give(w->arena, p->gave);
    arena_give(w->arena, p->most);
    arena_give(w->arena, p->more);
    int64_t cap = n + n / 4 + 64;
    p->item = take(w, 4 * cap, sizeof *p->item);
    p->vertex = take(w, 4 * cap, sizeof *p->vertex);
    p->share = take(w, cap, sizeof *p->share);
    p->gave = take(w, cap, sizeof *p->gave);
    p->most = take(w, cap, sizeof *p->most);
    p->more = take(w, cap, sizeof *p->more);
    c->cap = w->arena->failed ? 0 : cap;
    return w->arena->failed ? DRAPE_ENOMEM : DRAPE_OK;
}

/* One cloth: (A + hold) dv = force - g; what moves is moved. */
static int solve_sheet(struct world *w, struct sheet *s)
{
    struct couple *c = &w->couple;
    struct pcg *p = &s->solver.pcg;
    const vec *force = c->penalty.force + s->first;
    const sym *hold = c->penalty.hold + s->first;
    vec *g = c->g + s->first, *b = c->b + s->first, *dv = c->dv + s->first;
    real span = c->penalty.tau / c->penalty.dt;
    EACH_ITEM
    for (int64_t i = 0; i < s->cloth.count; i++)
        b[i] = s->cloth.fixed[i] ? vec_make(0, 0, 0) : vec_sub(force[i], g[i]);
    p->block = s->dynamics.block;
    p->thin = s->dynamics.thin;
    p->b = b;
    p->dv = dv;
    p->n_extra = s->cloth.count;
    p->extra = hold;
    p->energy = 1;
    p->tolerance = (real)w->def.tolerance;
    int status = ref_pcg(p);
    trace_stage(w->tracing, "pcg", dv, (size_t)s->cloth.count * sizeof *dv);
    p->n_extra = p->energy = 0;
    c->iterations += p->iterations;
    c->solves++;
    if (p->outcome != PCG_CONVERGED)
        c->outcome |= DRAPE_UNCONVERGED;
    if ((double)p->residual > c->residual)
        c->residual = (double)p->residual;
    if (status != DRAPE_OK || p->outcome == PCG_BREAKDOWN)
        return status; /* the exact rounds go on without */
    vec *u = w->response.u + s->first, *v = w->v1 + s->first;
    vec *x1 = w->x1 + s->first;
    const vec *x0 = w->x0 + s->first;
    EACH_ITEM
    for (int64_t i = 0; i < s->cloth.count; i++) {
        if (s->cloth.fixed[i])
            continue;
        vec done = vec_sub(vec_sub(b[i], p->r[i]), sym_apply(hold[i], dv[i]));
        g[i] = vec_add(g[i], done); /* A dv, whatever pcg left over */
        u[i] = vec_axpy(u[i], span, dv[i]);
        v[i] = vec_add(v[i], dv[i]);
        x1[i] = vec_axpy(x0[i], w->response.dt, u[i]);
        w->response.touched[s->first + i] = 1;
    }
    return DRAPE_OK;
}

/* What the solve of the free motion left over is the first turn's to do. */
static void carry(struct world *w)
{
    for (int k = 0; k < w->def.n_cloths; k++) {
        const struct sheet *s = &w->sheet[k];
        vec *g = w->couple.g + s->first;
        EACH_ITEM
        for (int64_t i = 0; i < s->cloth.count; i++)
            g[i] = vec_sub(g[i], s->solver.pcg.r[i]);
    }
}

/* What these contacts press with in the next slice. warm.md */
static int keep_warm(struct world *w)
{
    struct couple *c = &w->couple;
    struct penalty *p = &c->penalty;
    struct warm s = {.nv = p->nv,
                     .n = p->n,
                     .w = p->w,
                     .g = c->g,
                     .v = w->v0,
                     .contact = p->contact,
                     .before = w->press,
                     .part = COUPLE_KEPT / p->dt,
                     .again = COUPLE_GROWTH / COUPLE_KEPT * p->dt,
                     .speed = COUPLE_GUST * w->reach / p->dt,
                     .nv1 = p->nv1,
                     .n4 = p->n4,
                     .start = p->start,
                     .item = p->item,
                     .all = p->brake,
                     .press = c->press};
    return ref_warm(&s);
}

int couple_solve(void *user, int64_t n, struct contact *contact)
{
    struct world *w = user;
    struct penalty *p = &w->couple.penalty;
    double start = clock_now();
    int status = make_room(w, n);
    p->n = n;
    p->n4 = 4 * n;
    p->contact = contact;
    int turns = n > 0 && w->couple.solves == 0 ? TURNS : 1;
    for (int k = 0; k < turns && status == DRAPE_OK; k++) {
        p->first = w->couple.solves == 0;
        status = ref_penalty(p);
        trace_stage(w->tracing, "penalty", p->force,
                    (size_t)p->nv * sizeof *p->force);
        if (w->couple.rough && w->couple.solves == 0)
            carry(w);
        w->couple.residual = 0;
        for (int i = 0; i < w->def.n_cloths && status == DRAPE_OK; i++)
            status = solve_sheet(w, &w->sheet[i]);
    }
    if (status == DRAPE_OK && n > 0 && w->plan.warm) {
        status = keep_warm(w);
        trace_stage(w->tracing, "warm", w->couple.press,
                    (size_t)w->nc * sizeof *w->couple.press);
    }
    w->couple.seconds += clock_now() - start;
    return status;
}
