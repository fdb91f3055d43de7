/* SPDX-License-Identifier: Apache-2.0 */
/* The motion of all cloths with their contacts in one slice, on either backend.
 * spec/contact/lagrange.md */
#include "ref/contact/lagrange.h"

#include "ref/base/clock.h"
#include "ref/base/prescribed.h"
#include "ref/base/sum.h"
#include "ref/cloth/motion.h"
#include "ref/contact/carry.h"
#include "ref/contact/impulses.h"
#include "ref/contact/response.h"
#include "ref/contact/unknowns.h"
#include "ref/sleep/sleep.h"
#include "ref/solve/sewn.h"
#include "ref/world/state.h"

/* §3.4: linear systems after which an end need not be as near to balance; most
 * of a slice, and of Newton's part after them; most trials of a line search. */
enum { SOLVES = 12, MOST = 40, TRIALS = 12 };
static const real LATE = 10;        /* §3.4: times `tolerance`, from then on */
static const real FORCING = R(0.1); /* §3.2: tolerance of a linear system */
static const real NESTED = R(0.3);  /* §3.3: the inner residual is this part of
                                       the outer one where multipliers are
                                       renewed */
static const real SLOPE = R(0.1); /* §3.2: of the slope at a step's start, what
                                     a line search may leave */
static const real GROSS = 2;      /* §4: of what cloths carry, what linear
                                     springs may leave undone */
static const real UNDONE = R(0.05); /* §4: of the same, what Newton's part may
                                       leave undone */
static const real EARTH = R(9.81);  /* §3.4: m/s², the least g of the scale */
static const real STRUCK = R(0.5);  /* §5: of g dt */
static const real COLUMN_MODULUS = R(1e4); /* Pa, coulomb.md §1: the modulus of
                                     cloth across its thickness */

/* The loop under way. */
struct loop {
    struct world *w;
    struct lagrange *a;
    real g_dt;    /* m/s, what gravity changes in the slice, at least Earth's */
    real least;   /* §3.4: √m g dt */
    real carried; /* §4 */
    real scale;   /* §3.4 */
    real outer;   /* the last one */
    real met;     /* §4: what the pairs met last push */
    int from;     /* linear systems when this part of the slice began */
    int most;     /* linear systems */
    bool fresh;   /* the law was evaluated since M was made */
    bool moved;   /* since pairs were last looked for */
    bool clean;   /* nothing touches on the way to the iterate */
    int status;
};

static void note_status(struct loop *s, int status)
{
    s->status = s->status == DRAPE_OK ? status : s->status;
}

static bool loop_continues(const struct loop *s)
{
    return s->status == DRAPE_OK && !s->w->sleep->woken;
}

/* A part of the motion of all cloths that are awake. */
static int move_cloths(struct world *w, enum motion_part part)
{
    int status = DRAPE_OK;
    for (int k = 0; k < w->def.n_cloths && status == DRAPE_OK; k++)
        if (sleep_awake(w, k))
            status = w->run->motion_part(w->on, &w->sheet[k], part);
    return status;
}

/* rest becomes what the motions of the cloths lack. */
static void take_rest(struct world *w)
{
    for (int k = 0; k < w->def.n_cloths; k++) {
        const struct sheet *s = &w->sheet[k];
        vec *to = w->lagrange.rest + s->first;
        if (sleep_awake(w, k) && to != s->dynamics.b)
            w->run->copy(w->on, to, s->dynamics.b,
                         (size_t)s->cloth.count * sizeof *to);
    }
}

static void set_met(struct world *w, bool met)
{
    for (int k = 0; k < w->def.n_cloths; k++) {
        w->sheet[k].dynamics.met = met;
        w->sheet[k].dynamics.u = w->response.u + w->sheet[k].first;
    }
}

int lagrange_begin(struct world *w)
{
    w->lagrange.begun = true;
    set_met(w, true);
    int status = move_cloths(w, MOTION_OPEN);
    if (status != DRAPE_OK)
        return status;
    take_rest(w);
    for (int k = 0; k < w->def.n_cloths; k++)
        if (sleep_awake(w, k))
            w->run->clear(w->on, w->sheet[k].dynamics.dv,
                          (size_t)w->sheet[k].cloth.count * sizeof(vec));
    return move_cloths(w, MOTION_PLACE);
}

/* §3.1 */

static struct contact *contacts_of(const struct loop *s)
{
    const struct response *c = &s->w->response;
    return c->contact[c->side].data;
}

/* The contacts' law at the iterate, if the loop goes on. lists: the contacts
 * are others than before; renews: multipliers are renewed first. */
static void evaluate_contacts(struct loop *s, bool lists, bool renews)
{
    struct world *w = s->w;
    struct coulomb *law = &s->a->law;
    if (!loop_continues(s))
        return;
    law->seams = seams_contacts(&w->seams);
    law->hinges = w->seams.n_hinges;
    law->knits = w->seams.grids != NULL;
    law->n = w->response.active + law->seams;
    law->n4 = 4 * law->n;
    law->contact = contacts_of(s);
    law->rest = s->a->rest;
    law->bound = s->a->bound[!s->a->held];
    law->lists = lists;
    law->renews = renews;
    s->fresh = true;
    s->a->renewals += renews;
    note_status(s, w->run->coulomb(w->on, law));
    w->run->trace(w->on, w->tracing, "coulomb", law->force,
                  (size_t)law->nv * sizeof *law->force);
}

/* §3.5 */
static void close_contacts(struct loop *s)
{
    s->a->law.closes = 1;
    evaluate_contacts(s, false, false);
    s->a->law.closes = 0;
}

/* What a solve does not write of cloths that are asleep. */
static void clear_asleep(const struct loop *s)
{
    struct joint *j = &s->a->joint;
    vec *stream[] = {j->dv, j->r, j->p, j->p2, j->q};
    for (int k = 0; k < 5; k++)
        sleep_clear(s->w, stream[k], sizeof(vec));
    sleep_clear(s->w, j->item, sizeof *j->item);
}

/* The matrices of the seams that the preconditioner has, or none. */
static void take_matrices(struct loop *s, bool some)
{
    struct world *w = s->w;
    const struct coulomb *law = &s->a->law;
    if (!w->seams.grids)
        return; /* a world without contacts may have no pool of them */
    const struct contact *seams = law->contact + (law->n - law->seams);
    w->run->seam_matrix(w->on, w->seams.grids->n, some ? seams : NULL,
                        w->seams.grids->kappa);
}

/* The preconditioner, of the matrix at the iterate, if it is of another one;
 * §4: where springs are linearised anew, of theirs there. */
static void make_preconditioner(struct loop *s)
{
    struct world *w = s->w;
    struct joint *j = &s->a->joint;
    struct coulomb *law = &s->a->law;
    if (!s->fresh)
        return;
    s->fresh = false;
    if (s->a->newton)
        note_status(s, move_cloths(w, MOTION_LINEARISE));
    clear_asleep(s);
    s->a->held = !s->a->held;
    j->bound = s->a->bound[s->a->held];
    j->single = law->single;
    j->epoch = w->sleep->epoch;
    j->links = (struct links){.nv = law->nv,
                              .n = law->n,
                              .contact = law->contact,
                              .nv1 = law->nv1,
                              .n4 = law->n4,
                              .start = law->start,
                              .item = law->item,
                              .push = j->links.push};
    take_matrices(s, true);
    if (loop_continues(s))
        note_status(s, w->run->joint_set_up(w, j));
}

/* §3.4: the energy norm of a residual. */
static real measure_residual(struct loop *s, const vec *r)
{
    real value = 0;
    if (loop_continues(s))
        note_status(s, s->w->run->joint_measure(s->w, &s->a->joint, r, &value));
    if (!(value >= 0)) { /* rounding, or no number: the rounds go on */
        s->a->outcome |= DRAPE_UNCONVERGED;
        s->most = s->a->solves;
    }
    return value > 0 ? real_sqrt(value) : 0;
}

static real dot_streams(struct loop *s, const vec *a, const vec *b,
                        const real *weight)
{
    const struct joint *j = &s->a->joint;
    struct dot d = {.n = s->w->nc,
                    .a = a,
                    .b = b,
                    .n_chunks = j->n_chunks,
                    .chunk = j->chunk,
                    .n_w = weight ? s->w->nc : 0,
                    .w = weight};
    if (loop_continues(s))
        note_status(s, s->w->run->dot(s->w->on, &d));
    return d.value;
}

/* §3.4: what residuals are relative to. */
static void weigh_residuals(struct loop *s)
{
    const vec *force = s->a->law.force;
    real net = dot_streams(s, force, force, s->w->w);
    s->least = real_sqrt((real)s->w->mass) * s->g_dt;
    s->scale = real_max(s->least, real_sqrt(net));
}

/* §4: √(Σ m v²) of the slice's start, at least what gravity changes. */
static real find_carried(struct loop *s)
{
    struct world *w = s->w;
    real sum = 0;
    for (int k = 0; k < w->def.n_cloths && loop_continues(s); k++) {
        const struct sheet *sheet = &w->sheet[k];
        const vec *v = w->v0 + sheet->first;
        int64_t n = sheet->cloth.count;
        struct dot d = {.n = n,
                        .a = v,
                        .b = v,
                        .n_chunks = sum_chunks(n),
                        .chunk = s->a->joint.chunk,
                        .n_w = n,
                        .w = sheet->cloth.mass};
        note_status(s, w->run->dot(w->on, &d));
        sum += d.value;
    }
    return real_max(s->least, real_sqrt(sum));
}

/* §3.2 */

/* Moves along the solution by a part of it, to where `rest` and the law then
 * are. */
static void move_iterate(struct loop *s, real part)
{
    struct world *w = s->w;
    const struct joint *j = &s->a->joint;
    const struct coulomb *law = &s->a->law;
    struct shift m = {.count = w->nc,
                      .w = w->w,
                      .x0 = w->x0,
                      .dv = j->dv,
                      .part = part,
                      .span = law->tau / law->dt,
                      .dt = law->dt,
                      .u = w->response.u,
                      .v = w->v1,
                      .x1 = w->x1,
                      .touched = w->response.touched};
    w->run->unknowns_shift(w->on, &m);
    s->moved = true;
    s->clean = false;
    if (s->a->newton) {
        note_status(s, move_cloths(w, MOTION_BALANCE));
        take_rest(w);
    } else {
        w->run->unknowns_lessen(w->on, w->nc, part, j->q, s->a->rest);
    }
    evaluate_contacts(s, false, false);
}

/* The slope of the potential along the solution. */
static real potential_slope(struct loop *s)
{
    return -dot_streams(s, s->a->law.inner, s->a->joint.dv, NULL);
}

/* A root of the slope between two places by regula falsi: where the whole step
 * goes too far. */
static void search_line(struct loop *s, real from, real to)
{
    real low = 0, high = 1, at = 1, below = from, above = to;
    for (int k = 0; k < TRIALS && loop_continues(s); k++) {
        real part = -below / (above - below);
        part = part > R(0.1) ? real_min(part, R(0.9)) : R(0.1);
        real next = low + (high - low) * part;
        move_iterate(s, next - at);
        at = next;
        real value = potential_slope(s);
        if (!(real_abs(value) > SLOPE * -from))
            break;
        if (value > 0) {
            high = at;
            above = value;
        } else {
            low = at;
            below = value;
        }
    }
}

static void solve_step(struct loop *s)
{
    struct lagrange *a = s->a;
    struct joint *j = &a->joint;
    make_preconditioner(s);
    j->b = a->law.inner;
    j->tolerance = FORCING;
    j->max_iterations = s->w->def.max_iterations;
    if (!loop_continues(s))
        return;
    note_status(s, s->w->run->joint_solve(s->w, j));
    s->w->run->trace(s->w->on, s->w->tracing, "joint", j->dv,
                     (size_t)s->w->nc * sizeof *j->dv);
    a->solves++;
    a->iterations += j->iterations;
    if (j->outcome != PCG_CONVERGED)
        a->outcome |= DRAPE_UNCONVERGED;
    if (j->outcome == PCG_BREAKDOWN) {
        s->most = a->solves; /* the rounds go on from here */
        return;
    }
    real from = potential_slope(s);
    move_iterate(s, 1);
    real to = loop_continues(s) ? potential_slope(s) : 0;
    if (to > SLOPE * -from)
        search_line(s, from, to);
}

/* §2 */

static struct carry carry_of(const struct loop *s)
{
    const struct world *w = s->w;
    const struct coulomb *law = &s->a->law;
    return (struct carry){.nv = w->nv,
                          .n = w->response.active,
                          .n_kept = s->a->n_kept[0],
                          .w = w->w,
                          .surfaces = w->response.surfaces,
                          .dt = law->dt,
                          .tau = law->tau,
                          .stiffest = law->stiffest,
                          .kept = s->a->kept[0].data,
                          .contact = contacts_of(s)};
}

/* Sets up the contacts of the active set that are new. */
static void carry_multipliers(struct loop *s)
{
    struct world *w = s->w;
    struct carry c = carry_of(s);
    note_status(s, w->run->unknowns_room(w, c.n + seams_contacts(&w->seams)));
    if (s->status == DRAPE_OK)
        note_status(s, w->run->carry(w->on, &c));
    if (s->status != DRAPE_OK)
        return;
    w->run->trace(w->on, w->tracing, "carry", c.contact,
                  (size_t)c.n * sizeof *c.contact);
}

/* seam.md §2, §6: the points and hinges of all seams, as contacts behind the
 * active set. */
static struct seam seams_of(const struct loop *s)
{
    const struct world *w = s->w;
    return (struct seam){.n = w->seams.n,
                         .n_hinges = w->seams.n_hinges,
                         .point = w->seams.point,
                         .hinge = w->seams.hinge,
                         .x0 = w->x0,
                         .w = w->w,
                         .target = w->seams.next,
                         .pull = w->seams.pull,
                         .dt = s->a->law.dt,
                         .tau = s->a->law.tau,
                         .contact = contacts_of(s) + w->response.active,
                         .next = w->seams.next};
}

static void open_seams(struct loop *s)
{
    struct world *w = s->w;
    struct response *c = &w->response;
    struct pool *pool = &c->contact[c->side];
    struct blend way = {.n = w->seams.n,
                        .from = w->seams.from,
                        .to = w->seams.to,
                        .part = slice_part(w),
                        .x = w->seams.next};
    int64_t n = seams_contacts(&w->seams);
    if (c->active == 0 && pool->cap < n)
        note_status(s, w->run->grow(w->on, pool, ARENA_RESPONSE, n,
                                    sizeof(struct contact), true));
    if (w->seams.n == 0 || s->status != DRAPE_OK)
        return;
    w->run->prescribed_blend(w->on, &way);
    struct seam points = seams_of(s);
    w->run->seam_open(w->on, &points);
    w->run->trace(w->on, w->tracing, "seams", points.contact,
                  (size_t)n * sizeof *points.contact);
}

/* Copies the seams from behind the active set to where they outlast a change
 * of it, or back. */
static void set_aside_seams(struct loop *s, bool back)
{
    const struct world *w = s->w;
    if (w->seams.n == 0 || s->status != DRAPE_OK)
        return;
    struct contact *there = contacts_of(s) + w->response.active;
    struct contact *here = w->seams.aside;
    w->run->copy(w->on, back ? there : here, back ? here : there,
                 (size_t)seams_contacts(&w->seams) * sizeof *here);
}

/* §2: within which distance on the way pairs are looked for: 0 if no vertex
 * moves so far that a pair may arrive, roundings included. */
static real find_reach(struct loop *s)
{
    struct world *w = s->w;
    real spare = (w->response.range - 1) * w->thinnest;
    real most = loop_continues(s)
                    ? w->run->prescribed_furthest(w->on, w->nv, w->x0, w->x1)
                    : 0;
    return R(4.01) * most > spare * spare ? w->reach : 0;
}

/* Whether pairs touch on the way to the iterate, or arrive there; they become
 * contacts. */
static bool find_met(struct loop *s)
{
    struct response *c = &s->w->response;
    int64_t before = c->active;
    note_status(s, response_detect(c, find_reach(s)));
    s->moved = false;
    s->clean = loop_continues(s) && c->hits == 0;
    if (!loop_continues(s) || (s->clean && c->arrivals == 0))
        return false;
    set_aside_seams(s, false);
    note_status(s, response_join(c));
    set_aside_seams(s, true);
    if (s->clean && c->active == before)
        return false; /* what arrives had contacts already */
    if (s->status == DRAPE_OK)
        carry_multipliers(s);
    return loop_continues(s);
}

static void take_contacts(struct loop *s)
{
    if (!loop_continues(s))
        return;
    evaluate_contacts(s, true, false);
    make_preconditioner(s);
}

/* Takes in the pairs that were met. §4: a loose end asks what they push: by how
 * much they change `outer`. */
static void take_met(struct loop *s, bool loose)
{
    struct world *w = s->w;
    const vec *outer = s->a->law.outer;
    vec *change = s->a->joint.q;
    if (loose)
        w->run->copy(w->on, change, outer, (size_t)w->nc * sizeof *change);
    take_contacts(s);
    if (loose && loop_continues(s)) {
        w->run->unknowns_lessen(w->on, w->nc, 1, outer, change);
        s->met = measure_residual(s, change);
    }
}

/* §4: whether linear springs have left much undone. From here on they are
 * linearised at each iterate. */
static bool needs_linearisation(struct loop *s)
{
    struct world *w = s->w;
    if (s->a->newton || s->a->solves == 0 || !loop_continues(s))
        return false;
    note_status(s, move_cloths(w, MOTION_BALANCE));
    take_rest(w);
    evaluate_contacts(s, false, false);
    real left = measure_residual(s, s->a->law.inner);
    if (!(left > GROSS * s->least))
        return false; /* whatever the cloths carry */
    if (s->carried == 0)
        s->carried = find_carried(s);
    if (!(left > GROSS * s->carried))
        return false;
    s->a->newton = true;
    s->from = s->a->solves;
    s->most = s->from + MOST;
    return loop_continues(s);
}

/* §3.4: whatever presses, linear springs end with a tenth of what they may
 * leave undone (4), of which what gravity does is the least and is known. */
static real bound_end(struct loop *s, real enough)
{
    const real part = FORCING * GROSS;
    if (enough <= part * s->least)
        return enough;
    if (s->carried == 0)
        s->carried = find_carried(s);
    return real_min(enough, part * s->carried);
}

/* §5: what contacts are in balance with at the end, until the jump replaces it:
 * by linear springs, where these have served the slice. */
static void keep_rest(struct loop *s)
{
    const struct lagrange *a = s->a;
    if (a->jump && loop_continues(s))
        s->w->run->copy(s->w->on, a->jump, a->rest,
                        (size_t)s->w->nc * sizeof *a->jump);
}

/* §3: false where the loop ends. */
static bool iterate_loop(struct loop *s)
{
    struct lagrange *a = s->a;
    bool loose = a->newton && s->w->plan.newton <= 1;
    s->outer = measure_residual(s, a->law.outer);
    weigh_residuals(s);
    real tight = (real)s->w->def.tolerance * s->scale;
    real enough = a->newton || a->solves < SOLVES ? tight : LATE * tight;
    enough = loose ? UNDONE * s->carried : bound_end(s, enough);
    bool last = a->solves >= s->most;
    bool solved = !loose || s->moved || s->met <= tight;
    /* pairs that were found to touch wait for no system */
    bool answered = s->moved || s->clean;
    bool done = solved && answered && s->outer <= enough;
    /* impulses.md §1: only what is in balance shows that a κ is too small */
    s->w->response.stiffest = done ? a->law.stiffest : 0;
    if (s->moved && (done || last || a->solves == s->from + 1) && find_met(s)) {
        take_met(s, loose);
        if (!last)
            return loop_continues(s);
    }
    if (done || last) {
        keep_rest(s);
        return needs_linearisation(s);
    }
    if (measure_residual(s, a->law.inner) <= NESTED * s->outer)
        evaluate_contacts(s, false, true);
    if (loop_continues(s))
        solve_step(s);
    return loop_continues(s);
}

static struct loop loop_of(struct world *w)
{
    const double *g = w->def.gravity;
    real size = (real)sqrt(g[0] * g[0] + g[1] * g[1] + g[2] * g[2]);
    return (struct loop){.w = w,
                         .a = &w->lagrange,
                         .g_dt = real_max(size, EARTH) * (real)w->dt,
                         .most = MOST,
                         .moved = true};
}

static void start_loop(struct loop *s)
{
    struct world *w = s->w;
    struct lagrange *a = s->a;
    bool past = w->plan.history && state_has_past(w);
    a->law.dt = (real)w->dt;
    a->law.tau = (real)(past ? w->dt * 2 / 3 : w->dt);
    real column = COLUMN_MODULUS * w->cell * w->cell * a->law.tau * a->law.tau;
    column = real_max(R(1e-30), real_min(column, R(1e30))); /* of any scale */
    a->law.reach = w->cell / 2;
    a->law.give = CARRY_RISE / column;
    a->law.stiffest = column / (CONTACT_GIVE * a->law.reach);
    a->newton = w->plan.newton > 1;
    a->solves = a->iterations = a->renewals = a->outcome = 0;
    a->residual = 0;
}

/* The contacts of the slice's start. True if there is something to solve. */
static bool find_contacts(struct loop *s, const struct pairs *close)
{
    struct world *w = s->w;
    struct response *c = &w->response;
    note_status(s, response_find_close(c, close));
    if (s->status == DRAPE_OK)
        carry_multipliers(s);
    if (s->status == DRAPE_OK)
        open_seams(s);
    if (w->lagrange.begun || !loop_continues(s))
        return loop_continues(s);
    bool met = find_met(s); /* the cloths have moved already */
    if (!loop_continues(s) || (!met && c->active == 0))
        return false;
    set_met(w, true);
    note_status(s, move_cloths(w, MOTION_BALANCE));
    take_rest(w);
    return loop_continues(s);
}

/* §5: the jump of what struck, and the velocities after it. The system is that
 * of the cloths alone. */
static void take_jump(struct loop *s, const struct retain *r)
{
    struct world *w = s->w;
    struct lagrange *a = s->a;
    struct joint *j = &a->joint;
    struct jumps m = {.count = w->nc,
                      .w = w->w,
                      .contact = r->contact,
                      .kept = r->kept,
                      .start = a->law.start,
                      .item = a->law.item,
                      .rest = a->jump,
                      .push = a->jump};
    w->run->unknowns_jump(w->on, &m);
    if (!(dot_streams(s, a->jump, a->jump, NULL) > 0) || !loop_continues(s))
        return;
    j->b = a->jump;
    j->bound = j->single = a->bare;
    j->links.n = j->links.n4 = 0;
    take_matrices(s, false);
    j->links.start = a->none;
    j->tolerance = (real)w->def.tolerance;
    j->max_iterations = w->def.max_iterations;
    clear_asleep(s);
    note_status(s, w->run->joint_set_up(w, j));
    if (loop_continues(s))
        note_status(s, w->run->joint_solve(w, j));
    if (!loop_continues(s))
        return;
    a->iterations += j->iterations;
    w->run->copy(w->on, a->jump, j->dv, (size_t)w->nc * sizeof *a->jump);
    if (state_has_past(w))
        w->run->unknowns_lessen(w->on, w->nc, R(1.0) / 3, a->jump, w->v1);
}

/* §5: what the next slice carries on, and the velocities after impacts. */
static void finish_loop(struct loop *s)
{
    struct world *w = s->w;
    struct lagrange *a = s->a;
    struct pool *kept = &a->kept[1];
    int64_t n = w->response.active;
    if (n > kept->cap)
        note_status(s, w->run->grow(w->on, kept, ARENA_RESPONSE, n,
                                    sizeof(struct kept), true));
    struct retain r = {.nv = w->nv,
                       .n = n,
                       .w = w->w,
                       .u = w->response.u,
                       .v = w->v0,
                       .most = STRUCK * s->g_dt,
                       .contact = contacts_of(s),
                       .kept = kept->data};
    if (s->status == DRAPE_OK)
        note_status(s, w->run->retain(w->on, &r));
    if (s->status != DRAPE_OK)
        return;
    w->run->trace(w->on, w->tracing, "retain", r.kept,
                  (size_t)n * sizeof *r.kept);
    if (w->seams.n > 0) {
        struct seam points = seams_of(s);
        w->run->seam_close(w->on, &points);
    }
    a->n_kept[1] = n;
    a->struck = a->jump && n > 0;
    if (a->struck)
        take_jump(s, &r);
    lagrange_note(w);
    note_status(s, move_cloths(w, MOTION_END));
    for (int k = 0; k < w->def.n_cloths; k++)
        if (sleep_awake(w, k))
            a->outcome |= w->sheet[k].dynamics.outcome;
}

void lagrange_forget(struct world *w)
{
    struct lagrange *a = &w->lagrange;
    a->begun = a->solved = a->struck = false;
    a->n_kept[1] = 0;
}

void lagrange_note(struct world *w)
{
    size_t bytes = (size_t)w->nc * sizeof *w->x1;
    if (!w->free_x)
        return;
    w->run->copy(w->on, w->free_x, w->x1, bytes);
    w->run->copy(w->on, w->free_v, w->v1, bytes);
}

int lagrange_solve(void *user, const struct pairs *close)
{
    struct world *w = user;
    struct loop s = loop_of(w);
    double begin = clock_now(), broad = w->broad_seconds;
    start_loop(&s);
    if (find_contacts(&s, close)) {
        s.a->solved = true;
        take_contacts(&s);
        while (loop_continues(&s) && iterate_loop(&s))
            ;
        close_contacts(&s);
        s.a->residual = s.scale > 0 ? (double)(s.outer / s.scale) : 0;
    }
    if (loop_continues(&s) && s.a->solved)
        finish_loop(&s);
    w->response.done = s.clean;
    w->lagrange.seconds += clock_now() - begin - (w->broad_seconds - broad);
    return s.status == DRAPE_OK ? w->run->status(w->on) : s.status;
}

void lagrange_commit(struct world *w)
{
    struct lagrange *a = &w->lagrange;
    struct pool kept = a->kept[0];
    if (a->solved && w->seams.n > 0) {
        vec *pull = w->seams.pull;
        w->seams.pull = w->seams.next;
        w->seams.next = pull;
    }
    a->kept[0] = a->kept[1];
    a->kept[1] = kept;
    a->n_kept[0] = a->n_kept[1];
    a->n_kept[1] = 0;
}
