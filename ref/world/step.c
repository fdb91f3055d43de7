/* SPDX-License-Identifier: Apache-2.0 */
/* The pipeline of one step, for either backend. Its last function,
 * step_advance, reads as a table of contents. spec/world/step.md */
#include "ref/world/step.h"

#include "ref/base/clock.h"
#include "ref/base/threads.h"
#include "ref/cloth/implicit.h"
#include "ref/control/control.h"
#include "ref/momentum/conserve.h"
#include "ref/sleep/sleep.h"
#include "ref/world/collide.h"
#include "ref/world/ending.h"
#include "ref/world/prescribe.h"
#include "ref/world/restore.h"
#include "ref/world/slice.h"

enum { SMALL_SCENE = 4096 };

/* The current step. */
struct step {
    drape_step_report *all; /* the report of the step */
    drape_step_report r;    /* the report of the current slice */
    double last;            /* s, when the last part of the step ended */
    int status;
    bool asleep; /* the scene is asleep and stays so: the step is done */
    bool again;  /* the slice must be taken again */
};

/* Whether the rest of the current slice is to be computed. */
static bool slice_continues(const struct step *s)
{
    return s->status == DRAPE_OK && !s->again &&
           !(s->r.outcome & DRAPE_DIVERGED);
}

/* Adds the energies of all cloths in the state x, v to energy [3]. */
static void add_energies(const struct world *w, const vec *x, const vec *v,
                         double energy[3])
{
    for (int k = 0; k < w->def.n_cloths; k++) {
        struct sheet *s = &w->sheet[k];
        double value[3];
        const double *still = sleep_energy(w, k);
        if (!still)
            w->run->motion_energy(w->on, s, x + s->first, v + s->first, value);
        for (int j = 0; j < 3; j++)
            energy[j] += still ? still[j] : value[j];
    }
}

static void report_energy(drape_step_report *r, const double energy[3])
{
    r->kinetic = energy[0];
    r->elastic = energy[1];
    r->potential = energy[2];
}

/* Starts a step. Where all cloths are asleep and nothing is prescribed that is
 * all. */
static void begin_step(struct world *w, struct step *s)
{
    w->run->begin(w->on);
    memset(s->all, 0, sizeof *s->all);
    s->last = clock_now();
    if (w->tracing) {
        w->tracing->step = w->step;
        w->tracing->last = s->last;
    }
    sleep_note(w);
    slice_begin(w);
    control_begin(w);
    if (sleep_all(w) && w->plan.prescribed)
        s->status = prescribe_positions(w, slice_time(w), w->x1);
    s->asleep = sleep_all(w) && s->status == DRAPE_OK && !prescribe_moves(w);
    if (s->asleep)
        s->all->outcome = DRAPE_ASLEEP;
    else if (s->status == DRAPE_OK)
        s->status = sleep_hold(w);
}

static bool has_slice_left(const struct world *w, const struct step *s)
{
    return s->status == DRAPE_OK && !s->asleep && !slice_last(w) &&
           !(s->all->outcome & DRAPE_DIVERGED);
}

/* Begins a slice: obstacles and pins take their places at its end. */
static void place_prescribed(struct world *w, struct step *s)
{
    memset(&s->r, 0, sizeof s->r);
    s->again = false;
    w->met = false;
    s->status = prescribe_positions(w, slice_time(w), w->x1);
    w->prescribes = s->status == DRAPE_OK && prescribe_moves(w);
    if (s->status == DRAPE_OK)
        s->status = sleep_begin_slice(w);
    w->run->trace(w->on, w->tracing, "kinematics", w->x1 + w->nc,
                  (size_t)(w->nv - w->nc) * sizeof *w->x1);
}

/* Sets the inputs of the motion of cloth k. */
static void prepare_sheet(struct world *w, int k)
{
    struct sheet *s = &w->sheet[k];
    struct dynamics *d = &s->dynamics;
    d->x = w->x0 + s->first;
    d->v = w->v0 + s->first;
    d->xp = w->past_x ? w->past_x + s->first : NULL;
    d->vp = w->past_v ? w->past_v + s->first : NULL;
    d->dt = w->dt;
    d->has_past = state_has_past(w);
    d->to = w->to ? w->to + s->first : NULL;
    d->x1 = w->x1 + s->first;
    d->v1 = w->v1 + s->first;
    d->reference = w->watch[k][0];
    d->surplus = w->watch[k][1];
    d->iterations = 0;
    d->residual = 0;
    d->outcome = 0;
    d->tolerance = s->solver.pcg.tolerance = (real)w->def.tolerance;
    d->met = false;
    d->solves = 0;
    s->solver.seconds = 0;
}

static void report_sheet(const struct world *w, int k, drape_step_report *r)
{
    const struct sheet *s = &w->sheet[k];
    const struct dynamics *d = &s->dynamics;
    r->outcome |= d->outcome;
    r->iterations += d->iterations;
    r->work.solves += d->solves;
    r->residual = d->residual > r->residual ? d->residual : r->residual;
    r->substeps = d->substeps > r->substeps ? d->substeps : r->substeps;
    r->seconds[DRAPE_PART_SOLVER] += s->solver.seconds;
}

/* §2: moves each cloth as if nothing were in its way; or, where contacts are to
 * be expected, leaves this to the loop that solves them. */
static int move_sheets(struct world *w, drape_step_report *r)
{
    int n = w->def.n_cloths, status = DRAPE_OK;
    for (int k = 0; k < n; k++)
        if (sleep_awake(w, k))
            prepare_sheet(w, k);
    lagrange_forget(w);
    if (w->plan.solves && (w->nearness >= NEAR_CONTACTS || w->seams.n > 0))
        return lagrange_begin(w);
    for (int k = 0; k < n && status == DRAPE_OK; k++)
        if (sleep_awake(w, k))
            status = w->run->motion(w->on, &w->sheet[k]);
    if (status != DRAPE_OK)
        return status;
    for (int k = 0; k < n; k++)
        if (sleep_awake(w, k))
            report_sheet(w, k, r);
    lagrange_note(w);
    return w->run->status(w->on);
}

/* §2: moves all cloths without contact. A slice that diverged is taken again if
 * that is allowed; else it ends the step. */
static void move_cloths(struct world *w, struct step *s)
{
    if (slice_continues(s))
        s->status = move_sheets(w, &s->r);
    if (s->status == DRAPE_OK && w->plan.prescribed)
        prescribe_velocities(w);
    slice_charge(w, &s->r, DRAPE_PART_INTEGRATION, &s->last,
                 s->r.seconds[DRAPE_PART_SOLVER]);
    if (s->r.outcome & DRAPE_DIVERGED)
        s->again = slice_diverged(w);
}

static void check_travel(struct world *w, struct step *s)
{
    if (slice_continues(s) && w->plan.collides && !w->plan.solves)
        s->status = collide_far(w, &s->r, &s->last, &s->again);
}

/* §3.3: positions were in range before. If one no longer is, contact brought
 * it beyond, and the slice has diverged. */
static void handle_contact(struct world *w, struct step *s)
{
    if (!slice_continues(s) || !w->plan.collides || w->sleep->woken)
        return;
    s->status = collide_slice(w, &s->r, &s->last);
    if (s->status == DRAPE_EDATA) {
        s->status = DRAPE_OK;
        s->r.outcome |= DRAPE_DIVERGED;
    }
    if (s->r.outcome & DRAPE_DIVERGED)
        s->again = slice_diverged(w);
}

/* §6: a moving body near a cloth that is asleep wakes the cloth, and the slice
 * is taken again. */
static void wake_disturbed(struct world *w, struct step *s)
{
    if (s->status != DRAPE_OK || !w->sleep->woken)
        return;
    s->status = sleep_wake_disturbed(w);
    s->again = true;
}

/* §3.4: in empty space nothing but gravity changes momentum. */
static void conserve_slice(struct world *w, struct step *s)
{
    if (slice_continues(s))
        s->status = conserve_momentum(w, s->r.outcome);
}

/* §7.3: checks the slice by its outcome, and reports its energies. Those that
 * dynamics computed are used if contact did not change the state; if contact
 * may have changed it they are computed again, but only if somebody reads them.
 */
static void check_slice(struct world *w, struct step *s)
{
    double after[3] = {0};
    bool anew = w->met && w->reported;
    if (!slice_continues(s))
        return;
    for (int k = 0; k < w->def.n_cloths; k++) {
        const struct dynamics *d = &w->sheet[k].dynamics;
        const double *still = sleep_energy(w, k);
        for (int j = 0; j < 3; j++)
            after[j] += anew ? 0 : still ? still[j] : d->energy[j];
    }
    if (anew)
        add_energies(w, w->x1, w->v1, after);
    report_energy(&s->r, after);
    s->again = w->plan.collides && slice_wrong(w, s->r.outcome);
}

/* Stores the motion of n particles from `first` on as the past of the next
 * slice (implicit.md §4). Where contacts struck, the past gets the velocities
 * of lagrange.md §5. */
static void remember_run(struct world *w, int64_t first, int64_t n)
{
    bool collides = w->plan.collides, struck = w->lagrange.struck;
    struct history h = {.count = n,
                        .x0 = w->x0 + first,
                        .v0 = w->v0 + first,
                        .x1 = (collides ? w->free_x : w->x1) + first,
                        .v1 = (collides ? w->free_v : w->v1) + first,
                        .x = w->x1 + first,
                        .v = w->v1 + first,
                        .n_jump = struck ? n : 0,
                        .jump = struck ? w->lagrange.jump + first : NULL,
                        .part = state_has_past(w) ? R(2.0) / 3 : 1,
                        .dt = (real)w->dt,
                        .xp = w->past_x + first,
                        .vp = w->past_v + first};
    w->run->history(w->on, &h);
}

static void remember_state(struct world *w)
{
    sleep_runs(w, remember_run);
    w->run->trace(w->on, w->tracing, "history", w->past_v,
                  (size_t)w->nc * sizeof *w->past_v);
    w->past = 1 + w->slicing.level;
}

/* §4: makes the end of the slice the state. */
static void commit_slice(struct world *w, int outcome)
{
    if (w->plan.history)
        remember_state(w);
    w->nearness = state_nearness(&w->response);
    lagrange_commit(w);
    for (int k = 0; k < w->def.n_cloths; k++) {
        if (!sleep_awake(w, k))
            continue;
        w->watch[k][0] = w->sheet[k].dynamics.reference;
        w->watch[k][1] = w->sheet[k].dynamics.surplus;
    }
    sleep_count(w, outcome);
    vec *x = w->x0, *v = w->v0;
    w->x0 = w->x1;
    w->v0 = w->v1;
    w->x1 = x;
    w->v1 = v;
    slice_keep(w);
}

/* Ends a slice: adds its report to the step's and commits it, unless it is
 * taken again or failed. If the step may still fail after its first slice, the
 * start of the step is kept before that slice is committed. */
static void finish_slice(struct world *w, struct step *s)
{
    bool doubt = ending_doubtful(w, s->r.outcome);
    slice_report(s->all, &s->r, !s->again);
    if (slice_continues(s) && w->slicing.done == 0 &&
        (w->slicing.level > 0 || doubt))
        s->status = restore_save(w);
    if (slice_continues(s))
        commit_slice(w, s->r.outcome);
}

/* Ends a step: counts intersecting pairs where that is needed (§11), restores
 * the start of the step if the step failed, and completes the report. The
 * energies of a step that failed or is asleep are those of the state it keeps.
 */
static int end_step(struct world *w, struct step *s)
{
    drape_step_report *r = s->all;
    double energy[3] = {0};
    bool diverged = r->outcome & DRAPE_DIVERGED;
    int64_t found = w->intersecting;
    w->sewn = 0;
    if (s->status == DRAPE_OK && !diverged && !s->asleep &&
        ending_doubtful(w, r->outcome))
        s->status = ending_count(w, w->x0, &found);
    bool failed = s->status != DRAPE_OK || diverged;
    if (!s->asleep)
        control_end(w, failed);
    if (failed)
        restore_start(w);
    if (s->status != DRAPE_OK)
        return s->status;
    w->intersecting = found;
    if (diverged)
        r->outcome &= ~DRAPE_TRAPPED; /* the response's step is undone */
    ending_tell(w, r);
    w->step += !failed;
    w->time = (double)w->step * w->def.dt;
    if (failed || s->asleep) {
        add_energies(w, w->x0, w->v0, energy);
        report_energy(r, energy);
    }
    r->step = w->step;
    r->time = w->time;
    r->asleep = w->sleep->n;
    return w->run->status(w->on);
}

int step_advance(struct world *w, drape_step_report *report)
{
    drape_step_report unread;
    struct step s = {.all = report ? report : &unread};
    struct threads threads;
    w->reported = report != NULL;
    /* §8: in a small scene waking threads costs more than its loops; on a
     * device the host has no parallel loops, and may switch to another world
     * in the middle of this step. */
    if (!w->device)
        threads_begin(&threads, w->nv < SMALL_SCENE ? 1 : w->def.threads);
    begin_step(w, &s); /* §6: sleep */
    while (has_slice_left(w, &s)) {
        place_prescribed(w, &s); /* §1: kinematics.md */
        move_cloths(w, &s);      /* §2: wind.md … dynamics.md, pcg.md */
        check_travel(w, &s);     /* §7.2: travel.md */
        handle_contact(w, &s);   /* §3: refit.md … response.md */
        wake_disturbed(w, &s);   /* §6: sleep.md */
        conserve_slice(w, &s);   /* §3.4: momentum.md */
        check_slice(w, &s);      /* §7.3: energy.md */
        finish_slice(w, &s);     /* step.md §4, §6, §7.4: implicit.md */
    }
    int status = end_step(w, &s); /* step.md §11: audit.md */
    if (!w->device)
        threads_end(&threads);
    return status;
}
