/* SPDX-License-Identifier: Apache-2.0 */
/* Contacts within the implicit solve of all cloths, on either backend.
 * spec/contact/penalty.md §4 */
#include "ref/contact/couple.h"

#include "ref/base/clock.h"
#include "ref/base/sum.h"
#include "ref/contact/turn.h"
#include "ref/contact/warm.h"
#include "ref/sleep/sleep.h"
#include "ref/world/state.h"

static const real ROUGH = R(0.3);     /* tolerance of what the next solve takes
                                         up again */
static const real FINE = R(1.0) / 32; /* of the tolerance, after a motion that
                                         was not solved roughly */
static const real SLIP = R(5e-4);     /* m/s, friction is viscous below */
static const real GIVE = R(0.03);     /* of the reach, penalty.md §1.4 */
static const real LIGHT = R(50.0);    /* particles; what a contact weighs that
                                         bears its own at rest */
static const real EASE = R(10.0);   /* the largest e, §4.3, and the tolerances
                                       that |r| of all turns but the last meets */
static const real LOOSE = R(100.0); /* the same of a first turn among cloths
                                       that hit each other */

bool couple_prepare(const struct world *w, struct pcg *p)
{
    bool rough =
        w->near >= NEAR_CONTACTS && w->plan.implicit && !w->plan.history;
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
    p->give = GIVE * w->reach;
    c->iterations = c->solves = c->follows = c->outcome = 0;
    c->turn = c->turns = 0;
    c->calm = false;
    c->residual = 0;
    c->seconds = 0;
    if (!c->moved)
        c->joint.scale = c->joint.square = 0;
    for (int k = 0; k < w->def.n_cloths && c->rough && !c->moved; k++) {
        if (!sleep_awake(w, k))
            continue;
        c->joint.scale += w->sheet[k].solver.pcg.scale;
        c->joint.square += w->sheet[k].solver.pcg.square;
    }
    w->run->turn_begin(w->on, w->nc, c->g, state_warm(w) ? w->press : NULL,
                       p->dt);
    w->run->copy(w->on, c->given, c->g, (size_t)w->nc * sizeof *c->g);
}

static struct turn turn_of(const struct world *w)
{
    const struct couple *c = &w->couple;
    return (struct turn){.count = w->nc,
                         .w = w->w,
                         .force = c->penalty.force,
                         .dv = c->joint.dv,
                         .q = c->joint.q,
                         .r = c->joint.r,
                         .g = c->g,
                         .given = c->given,
                         .b = c->b,
                         .x0 = w->x0,
                         .u = w->response.u,
                         .v = w->v1,
                         .x1 = w->x1,
                         .touched = w->response.touched,
                         .span = c->penalty.tau / c->penalty.dt,
                         .dt = w->response.dt};
}

/* The contacts' part of the joint matrix, as penalty left them. */
static struct links links_of(const struct penalty *p, vec *push)
{
    return (struct links){.nv = p->nv,
                          .n = p->n,
                          .contact = p->contact,
                          .across = p->tau / p->dt,
                          .nv1 = p->nv1,
                          .n4 = p->n4,
                          .start = p->start,
                          .item = p->item,
                          .push = push};
}

/* §4.3: e, how many times the pushes of contacts count, which are lighter than
 * the stiffest. */
static real ease_of(const struct world *w)
{
    const struct penalty *p = &w->couple.penalty;
    real mean = (real)w->mass / (real)w->nc;
    real heavy = p->stiffness * p->tau * p->tau / mean;
    return real_min(real_max(real_sqrt(heavy / LIGHT), 1), EASE);
}

/* How well a joint solve is done. MOTION: roughly, in both norms of pcg.md
 * §4.1. FIRST and MIDDLE, of all turns but the last: roughly in the energy
 * norm, less so in the other, as the next turn takes its friction from what
 * contacts press. LAST, of several turns, and WHOLE: to the tolerance. */
enum care { MOTION, FIRST, MIDDLE, LAST, WHOLE };

/* §4.5: which of the kept solutions such a solve begins along; COUPLE_ENDS:
 * none. */
static int end_of(enum care care)
{
    return care == FIRST ? 0 : care == LAST ? 1 : COUPLE_ENDS;
}

static bool is_early(enum care care)
{
    return care == FIRST || care == MIDDLE;
}

/* The tolerance of a solve to the end. */
static real fine_of(const struct world *w)
{
    return (real)w->def.tolerance * (w->plan.history ? FINE : 1);
}

/* §4.3: what |r| of a solve is to meet. */
static real exact_of(const struct world *w, enum care care)
{
    bool hits = w->response.foresee && w->def.n_cloths > 1;
    if (is_early(care))
        return fine_of(w) * (care == FIRST && hits ? LOOSE : EASE);
    return w->couple.joint.tolerance;
}

/* What the solve does not write of cloths that are asleep. */
static void clear_asleep(struct world *w)
{
    struct joint *s = &w->couple.joint;
    vec *stream[] = {w->couple.b, s->dv, s->p, s->p2, s->q};
    for (int k = 0; k < 5; k++)
        sleep_clear(w, stream[k], sizeof(vec));
    sleep_clear(w, s->item, sizeof *s->item);
}

/* Solves (A + wall + C) dv = b. */
static int run_joint(struct world *w, enum care care)
{
    int end = end_of(care);
    struct couple *c = &w->couple;
    struct joint *s = &c->joint;
    s->nc = w->nc;
    s->hold = c->penalty.hold;
    s->wall = c->penalty.wall;
    s->b = c->b;
    s->last = end < COUPLE_ENDS ? w->solved + end * w->nc : NULL;
    s->links = links_of(&c->penalty, s->links.push);
    real asked = fine_of(w);
    s->weigh = care == FIRST;
    s->tolerance =
        care == LAST || care == WHOLE ? asked : real_max(asked, ROUGH);
    s->exact = exact_of(w, care);
    s->max_iterations = w->def.max_iterations;
    s->epoch = w->sleep->epoch;
    clear_asleep(w);
    int status = w->run->joint(w, s);
    w->run->trace(w->on, w->tracing, "joint", s->dv,
                  (size_t)w->nc * sizeof *s->dv);
    return status;
}

/* The systems of all cloths, of which no contact is part. */
static int open_sheets(struct world *w)
{
    struct couple *c = &w->couple;
    struct penalty *p = &c->penalty;
    int status = DRAPE_OK;
    for (int k = 0; k < w->def.n_cloths && status == DRAPE_OK; k++) {
        struct sheet *s = &w->sheet[k];
        vec *b = c->b + s->first;
        if (!sleep_awake(w, k))
            continue;
        status = w->run->motion_open(w->on, s);
        if (b != s->dynamics.b)
            w->run->copy(w->on, b, s->dynamics.b,
                         (size_t)s->cloth.count * sizeof *b);
    }
    p->n = p->n4 = 0;
    w->run->clear(w->on, p->hold, (size_t)p->nv * sizeof *p->hold);
    w->run->clear(w->on, p->wall, (size_t)p->nv * sizeof *p->wall);
    w->run->clear(w->on, p->start, (size_t)p->nv1 * sizeof *p->start);
    return status;
}

int couple_move(struct world *w, drape_step_report *r)
{
    struct couple *c = &w->couple;
    struct joint *s = &c->joint;
    double start = clock_now();
    memset(c->kept, 0, sizeof c->kept);
    c->moved = w->def.n_cloths - w->sleep->n > 1 && w->plan.implicit &&
               w->plan.collides && !w->plan.history && w->plan.newton == 1 &&
               w->def.solver == DRAPE_EXACT;
    if (!c->moved)
        return DRAPE_OK;
    int status = open_sheets(w);
    s->scale = s->square = 0;
    if (status == DRAPE_OK)
        status = run_joint(w, c->rough ? MOTION : WHOLE);
    c->moved = s->outcome != PCG_BREAKDOWN;
    if (c->moved && !c->rough)
        r->residual = fmax(r->residual, (double)s->residual);
    r->seconds[DRAPE_PART_SOLVER] += clock_now() - start;
    r->iterations += s->iterations;
    r->work.solves++;
    if (s->outcome == PCG_LIMIT)
        r->outcome |= DRAPE_UNCONVERGED;
    for (int k = 0; k < w->def.n_cloths && status == DRAPE_OK && c->moved; k++)
        if (sleep_awake(w, k))
            status = w->run->motion_close(w->on, &w->sheet[k],
                                          s->dv + w->sheet[k].first);
    return status;
}

/* §4.5: keeps the solution of the first or the last turn, end 0 or 1, unless
 * the solve failed. */
static void keep(struct world *w, int end)
{
    struct couple *c = &w->couple;
    const struct joint *s = &c->joint;
    bool good = s->outcome != PCG_BREAKDOWN && s->residual - s->residual == 0;
    c->kept[end] = good;
    if (good)
        w->run->copy(w->on, c->found[end], s->dv,
                     (size_t)w->nc * sizeof *s->dv);
}

/* §4.3: raises what the tolerance is relative to, two squares, as if what
 * springs push were so many times as large. */
static void count_pushes(struct joint *s, real times)
{
    s->scale = real_min(REAL_BIG, s->scale * (times * times));
    s->square = real_min(REAL_BIG, s->square * (times * times));
}

/* |b| by what the tolerance is relative to, and by `most`, §4.3. */
static int test_size(struct world *w, real most, real *size)
{
    struct couple *c = &w->couple;
    const struct joint *s = &c->joint;
    struct dot d = {w->nc, c->b, c->b, s->n_chunks, s->chunk, 0};
    int status = w->run->dot(w->on, &d);
    *size = d.value > 0 ? real_sqrt(d.value / (s->square / (most * most))) : 0;
    return status;
}

/* Solves (A + wall + C) dv = b and moves what moves. After a breakdown the
 * exact rounds go on without. */
static int solve_joint(struct world *w, enum care care)
{
    struct couple *c = &w->couple;
    struct joint *s = &c->joint;
    struct turn moves = turn_of(w);
    int end = end_of(care);
    real e = is_early(care) ? ease_of(w) : 1;
    count_pushes(s, 1 / e);
    int status = run_joint(w, care);
    count_pushes(s, e);
    if (status == DRAPE_OK && end < COUPLE_ENDS)
        keep(w, end);
    c->iterations += s->iterations;
    c->solves++;
    if (s->outcome != PCG_CONVERGED)
        c->outcome |= DRAPE_UNCONVERGED;
    c->residual = (double)s->residual;
    if (s->outcome == PCG_BREAKDOWN) /* all is left undone */
        w->run->copy(w->on, s->r, c->b, (size_t)w->nc * sizeof *s->r);
    moves.moves = s->outcome != PCG_BREAKDOWN && s->iterations > 0;
    if (status == DRAPE_OK)
        w->run->turn_move(w->on, &moves);
    w->run->turn_end(w->on);
    return status == DRAPE_OK ? w->run->status(w->on) : status;
}

static void add_residual(const struct world *w)
{
    const struct couple *c = &w->couple;
    if (c->moved) {
        w->run->turn_carry(w->on, w->nc, c->joint.r, c->g);
        return;
    }
    for (int k = 0; k < w->def.n_cloths; k++) {
        const struct sheet *s = &w->sheet[k];
        if (!sleep_awake(w, k))
            continue;
        const vec *r = s->dynamics.left ? s->dynamics.left : s->solver.pcg.r;
        w->run->turn_carry(w->on, s->cloth.count, r, w->couple.g + s->first);
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
                     .g = c->given,
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

/* What the k-th of so many turns is. */
static enum care care_of(int k, int turns)
{
    if (turns == 1)
        return WHOLE;
    if (k + 1 == turns)
        return LAST;
    return k == 0 ? FIRST : MIDDLE;
}

/* The next turn, which is the last if it leaves nothing to those after it. */
static int take_turn(struct world *w)
{
    struct couple *c = &w->couple;
    struct penalty *p = &c->penalty;
    struct turn s = turn_of(w);
    real size = REAL_BIG;
    bool known = c->solves > 0 && !w->response.anew;
    p->first = !known;
    /* §2.2: the very first turn knows of no friction yet. */
    p->far = c->solves == 0 ? REAL_BIG : w->reach;
    int status = w->run->penalty(w->on, p);
    w->run->trace(w->on, w->tracing, "penalty", p->force,
                  (size_t)p->nv * sizeof *p->force);
    if (c->solves == 0 && c->rough)
        add_residual(w);
    w->run->turn_load(w->on, &s);
    if (status == DRAPE_OK && known && care_of(c->turn, c->turns) == MIDDLE)
        status = test_size(w, ease_of(w), &size);
    if (size <= fine_of(w) * EASE)
        c->turns = c->turn + 1;
    if (status == DRAPE_OK)
        status = solve_joint(w, care_of(c->turn, c->turns));
    c->turn++;
    w->response.anew = false;
    return status == DRAPE_OK ? w->run->penalty_status(w->on) : status;
}

/* §4.7: friction follows the loads that the last solve found. joins: contacts
 * that came after the turns take part. */
static int follow(struct world *w, bool joins)
{
    struct couple *c = &w->couple;
    struct penalty *p = &c->penalty;
    struct turn s = turn_of(w);
    real size = 0;
    bool solved = !c->calm && c->joint.outcome != PCG_BREAKDOWN;
    p->first = 0;
    p->far = w->reach;
    p->follows = 1;
    p->joins = joins;
    p->n_dv = solved ? p->nv : 0;
    p->dv = c->joint.dv;
    int status = w->run->penalty(w->on, p);
    p->follows = 0;
    w->run->trace(w->on, w->tracing, "penalty", p->force,
                  (size_t)p->nv * sizeof *p->force);
    w->run->turn_load(w->on, &s);
    if (status == DRAPE_OK)
        status = test_size(w, 1, &size);
    if (status != DRAPE_OK)
        return status;
    c->calm = !joins && size <= fine_of(w);
    if (c->calm) {
        c->residual = (double)size;
        w->run->copy(w->on, c->joint.r, c->b, (size_t)w->nc * sizeof *c->b);
    } else {
        c->follows++;
        status = solve_joint(w, WHOLE);
    }
    return status == DRAPE_OK ? w->run->penalty_status(w->on) : status;
}

/* The same until it changes less than the tolerance, COUPLE_FOLLOWS times at
 * most. */
static int follow_loads(struct world *w)
{
    const struct couple *c = &w->couple;
    int status = DRAPE_OK;
    for (int k = 0; k < COUPLE_FOLLOWS && status == DRAPE_OK && !c->calm &&
                    c->joint.outcome != PCG_BREAKDOWN;
         k++)
        status = follow(w, false);
    return status;
}

/* How many turns are to come, §4.3: those of the slice's contacts, or what is
 * left of turns that wait, one more if their contacts are others now. */
static void count_turns(struct world *w, int64_t n)
{
    struct couple *c = &w->couple;
    if (c->turn < c->turns) {
        c->turns += w->response.anew;
        return;
    }
    c->turn = 0;
    c->turns = n == 0 ? 1 : c->solves == 0 ? COUPLE_TURNS : 0;
}

int couple_solve(void *user, int64_t n, struct contact *contact)
{
    struct world *w = user;
    struct response *r = &w->response;
    struct couple *c = &w->couple;
    struct penalty *p = &c->penalty;
    double start = clock_now();
    int status = w->run->turn_room(w, n);
    p->n = n;
    p->n4 = 4 * n;
    p->contact = contact;
    count_turns(w, n);
    bool foresees = r->foresee && !r->waits && !r->waited;
    r->waits = false;
    while (c->turn < c->turns && status == DRAPE_OK && !r->waits) {
        status = take_turn(w);
        r->waits = (r->pauses && c->turn == 1) ||
                   (foresees && c->turn > 0 && c->turn + 1 == c->turns);
    }
    if (status == DRAPE_OK && c->turns == 0)
        status = follow(w, true);
    c->calm = false;
    if (status == DRAPE_OK && n > 0 && !r->waits && w->rubs)
        status = follow_loads(w);
    if (status == DRAPE_OK && n > 0 && w->plan.warm && !r->waits) {
        status = keep_warm(w);
        w->run->trace(w->on, w->tracing, "warm", w->couple.press,
                      (size_t)w->nc * sizeof *w->couple.press);
    }
    w->couple.seconds += clock_now() - start;
    return status;
}
