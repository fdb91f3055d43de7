/* SPDX-License-Identifier: Apache-2.0 */
/* Contacts within the implicit solve of every cloth, on either backend.
 * spec/contact/penalty.md §4 */
#include "ref/contact/couple.h"

#include "ref/base/clock.h"
#include "ref/contact/turn.h"
#include "ref/contact/warm.h"
#include "ref/world/state.h"

enum { TURNS = 2 }; /* of the first contacts of a slice; later ones: 1 */
static const real ROUGH = R(0.1);     /* tolerance of a motion before contact */
static const real FINE = R(1.0) / 32; /* of the tolerance, after a motion that
                                         was not solved roughly */
static const real SLIP = R(5e-4);     /* m/s, friction is viscous below */

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
    p->slip = real_min(SLIP, R(0.01) * w->reach / p->dt);
    p->tau = (real)(past ? w->dt * 2 / 3 : w->dt);
    c->iterations = c->solves = c->outcome = 0;
    c->residual = 0;
    c->seconds = 0;
    w->run->turn_begin(w->on, w->nc, c->g, state_warm(w) ? w->press : NULL,
                       p->dt);
}

static struct turn turn_of(const struct world *w, const struct sheet *s)
{
    const struct couple *c = &w->couple;
    int64_t at = s->first;
    return (struct turn){.count = s->cloth.count,
                         .fixed = s->cloth.fixed,
                         .force = c->penalty.force + at,
                         .hold = c->penalty.hold + at,
                         .r = s->solver.pcg.r,
                         .dv = c->dv ? c->dv + at : s->dynamics.dv,
                         .g = c->g + at,
                         .b = c->b + at,
                         .x0 = w->x0 + at,
                         .u = w->response.u + at,
                         .v = w->v1 + at,
                         .x1 = w->x1 + at,
                         .touched = w->response.touched + at,
                         .span = c->penalty.tau / c->penalty.dt,
                         .dt = w->response.dt};
}

/* One cloth: (A + hold) dv = force - g; what moves is moved. After a breakdown
 * the exact rounds go on without. */
static int solve_sheet(struct world *w, struct sheet *s)
{
    struct couple *c = &w->couple;
    struct pcg *p = &s->solver.pcg;
    struct turn turn = turn_of(w, s);
    w->run->turn_load(w->on, &turn);
    p->block = s->dynamics.block;
    p->thin = s->dynamics.thin;
    p->b = turn.b;
    p->dv = turn.dv;
    p->n_extra = s->cloth.count;
    p->extra = turn.hold;
    p->energy = 1;
    p->tolerance = (real)w->def.tolerance;
    if (w->plan.history)
        p->tolerance *= FINE;
    int status = w->run->solve(w->on, s);
    w->run->trace(w->on, w->tracing, "pcg", turn.dv,
                  (size_t)turn.count * sizeof *turn.dv);
    p->n_extra = p->energy = 0;
    c->iterations += p->iterations;
    c->solves++;
    if (p->outcome != PCG_CONVERGED)
        c->outcome |= DRAPE_UNCONVERGED;
    if ((double)p->residual > c->residual)
        c->residual = (double)p->residual;
    if (status == DRAPE_OK && p->outcome != PCG_BREAKDOWN)
        w->run->turn_move(w->on, &turn);
    w->run->turn_end(w->on);
    return status == DRAPE_OK ? w->run->status(w->on) : status;
}

static void add_residual(const struct world *w)
{
    for (int k = 0; k < w->def.n_cloths; k++) {
        const struct dynamics *d = &w->sheet[k].dynamics;
        struct turn turn = turn_of(w, &w->sheet[k]);
        turn.r = d->left ? d->left : turn.r;
        w->run->turn_carry(w->on, &turn);
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
                     .all = p->parts,
                     .press = c->press};
    return w->run->warm(w->on, &s);
}

int couple_solve(void *user, int64_t n, struct contact *contact)
{
    struct world *w = user;
    struct penalty *p = &w->couple.penalty;
    double start = clock_now();
    int status = w->run->turn_room(w, n);
    p->n = n;
    p->n4 = 4 * n;
    p->contact = contact;
    int turns = n > 0 && w->couple.solves == 0 ? TURNS : 1;
    for (int k = 0; k < turns && status == DRAPE_OK; k++) {
        p->first = w->couple.solves == 0;
        status = w->run->penalty(w->on, p);
        w->run->trace(w->on, w->tracing, "penalty", p->force,
                      (size_t)p->nv * sizeof *p->force);
        if (w->couple.rough && w->couple.solves == 0)
            add_residual(w);
        w->couple.residual = 0;
        for (int i = 0; i < w->def.n_cloths && status == DRAPE_OK; i++)
            status = solve_sheet(w, &w->sheet[i]);
        if (status == DRAPE_OK)
            status = w->run->penalty_status(w->on);
    }
    if (status == DRAPE_OK && n > 0 && w->plan.warm) {
        status = keep_warm(w);
        w->run->trace(w->on, w->tracing, "warm", w->couple.press,
                      (size_t)w->nc * sizeof *w->couple.press);
    }
    w->couple.seconds += clock_now() - start;
    return status;
}
