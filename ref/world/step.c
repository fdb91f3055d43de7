/* SPDX-License-Identifier: Apache-2.0 */
/* The pipeline of one step; step_advance is its table of contents.
 * spec/world/step.md */
#include "ref/world/step.h"

#include <stdio.h>

#include "ref/base/clock.h"
#include "ref/base/threads.h"
#include "ref/cloth/advance.h"
#include "ref/cloth/implicit.h"
#include "ref/world/collide.h"
#include "ref/world/ending.h"
#include "ref/world/lead.h"
#include "ref/world/slice.h"

enum { REST_STEPS = 30, SMALL_SCENE = 4096 };
static const double REST_PART = 1e-3; /* of the thickness, a step */

/* ---- §3 Motion without contact ---- */

static int move_sheet(struct world *w, int k, drape_step_report *r)
{
    struct sheet *s = &w->sheet[k];
    struct dynamics *d = &s->dynamics;
    d->x = w->x0 + s->first;
    d->v = w->v0 + s->first;
    d->xp = w->past_x ? w->past_x + s->first : NULL;
    d->vp = w->past_v ? w->past_v + s->first : NULL;
    d->dt = w->dt;
    d->has_past = state_has_past(w);
    d->to = w->to + s->first;
    d->x1 = w->x1 + s->first;
    d->v1 = w->v1 + s->first;
    d->reference = w->watch[k][0];
    d->surplus = w->watch[k][1];
    d->iterations = 0;
    d->residual = 0;
    d->outcome = 0;
    w->couple.rough = couple_prepare(w, &s->solver.pcg);
    d->press = state_warm(w) ? w->press + s->first : NULL;
    int status = ref_dynamics(d);
    if (status != DRAPE_OK)
        return status;
    r->outcome |= d->outcome;
    r->iterations += d->iterations;
    r->work.solves += w->plan.implicit;
    r->residual = d->residual > r->residual ? d->residual : r->residual;
    r->substeps = d->substeps > r->substeps ? d->substeps : r->substeps;
    return DRAPE_OK;
}

static int move(struct world *w, drape_step_report *r)
{
    int status = DRAPE_OK;
    for (int k = 0; k < w->def.n_cloths && status == DRAPE_OK; k++)
        status = move_sheet(w, k, r);
    if (status != DRAPE_OK)
        return status;
    if (w->plan.led)
        lead_velocities(w);
    if (w->plan.history && w->plan.collides) {
        memcpy(w->free_x, w->x1, (size_t)w->nc * sizeof *w->x1);
        memcpy(w->free_v, w->v1, (size_t)w->nc * sizeof *w->v1);
    }
    return DRAPE_OK;
}

/* ---- §5 The end of a step ---- */

static void remember(struct world *w)
{
    bool collides = w->plan.collides;
    struct history h = {.count = w->nc,
                        .x0 = w->x0,
                        .v0 = w->v0,
                        .x1 = collides ? w->free_x : w->x1,
                        .v1 = collides ? w->free_v : w->v1,
                        .x = w->x1,
                        .v = w->v1,
                        .dt = (real)w->dt,
                        .xp = w->past_x,
                        .vp = w->past_v};
    ref_history(&h);
    trace_stage(w->tracing, "history", w->past_v,
                (size_t)w->nc * sizeof *w->past_v);
    w->past = 1 + w->slicing.level;
}

/* §6: whether no particle went further than a part of the thickness. */
static bool rests(const struct world *w, int outcome)
{
    real most = (real)REST_PART * w->reach;
    return w->def.sleep && !slice_failed(outcome) && w->slicing.level == 0 &&
           collide_furthest(w, w->nc) <= most * most;
}

static void keep_press(struct world *w, bool held)
{
    size_t bytes = (size_t)w->nc * sizeof *w->press;
    if (!w->plan.warm)
        return;
    if (held)
        memcpy(w->press, w->couple.press, bytes);
    else if (w->pressed)
        memset(w->press, 0, bytes);
    w->pressed = held;
}

static void commit(struct world *w, int outcome)
{
    if (w->plan.history)
        remember(w);
    w->resting = rests(w, outcome) ? w->resting + 1 : 0;
    w->asleep = w->resting >= REST_STEPS;
    w->near = state_nearness(&w->response);
    keep_press(w, !slice_failed(outcome) && w->near == NEAR_CONTACTS);
    for (int k = 0; k < w->def.n_cloths; k++) {
        w->watch[k][0] = w->sheet[k].dynamics.reference;
        w->watch[k][1] = w->sheet[k].dynamics.surplus;
    }
    vec *x = w->x0, *v = w->v0;
    w->x0 = w->x1;
    w->v0 = w->v1;
    w->x1 = x;
    w->v1 = v;
    slice_keep(w);
}

/* Energies of a state of all cloths, which are 0 before. */
static void weigh(const struct world *w, const vec *x, const vec *v,
                  double energy[3])
{
    for (int k = 0; k < w->def.n_cloths; k++) {
        double value[3];
        dynamics_energy(&w->sheet[k].dynamics, x + w->sheet[k].first,
                        v + w->sheet[k].first, value);
        for (int j = 0; j < 3; j++)
            energy[j] += value[j];
    }
}

/* ---- The pipeline ---- */

int step_check(struct world *w, drape_error *error)
{
    for (int k = 0; k < w->def.n_cloths && !w->plan.implicit; k++) {
        const struct cloth *c = &w->sheet[k].cloth;
        int32_t n = advance_substeps(w->def.integrator, w->def.dt, c->bound,
                                     (double)c->beta);
        if (n <= w->def.max_substeps)
            continue;
        if (error)
            snprintf(error->text, sizeof error->text,
                     "cloth %d: stable from %d substeps on, max_substeps is "
                     "%d",
                     k, (int)n, w->def.max_substeps);
        return DRAPE_ELIMIT;
    }
    return DRAPE_OK;
}

static void tell(drape_step_report *r, const double energy[3])
{
    r->kinetic = energy[0];
    r->elastic = energy[1];
    r->potential = energy[2];
}

/* §7.3: *again: the slice ended badly, and a shorter one is wanted. Dynamics
 * weighed what contact has left alone. */
static void judge(struct world *w, drape_step_report *r, bool *again)
{
    double before[3] = {0}, after[3] = {0};
    bool anew = w->met && (w->reported || slice_weighs(w));
    for (int k = 0; k < w->def.n_cloths; k++)
        for (int j = 0; j < 3; j++) {
            before[j] += w->sheet[k].dynamics.before[j];
            after[j] += anew ? 0 : w->sheet[k].dynamics.energy[j];
        }
    if (anew)
        weigh(w, w->x1, w->v1, after);
    tell(r, after);
    *again = w->plan.collides && slice_wrong(w, r->outcome, before, after);
}

/* One slice of a step, from the state to the state, or to a shorter slice. */
static int slice(struct world *w, drape_step_report *all, double *last)
{
    drape_step_report r = {0};
    bool again = false;
    w->met = false;
    int status = lead(w, slice_time(w), w->x1); /* 01 kinematics */
    trace_stage(w->tracing, "kinematics", w->x1 + w->nc,
                (size_t)(w->nv - w->nc) * sizeof *w->x1);
    if (status == DRAPE_OK)
        status = move(w, &r); /* 03 wind … 09 dynamics, 10 sum … 15 pcg */
    for (int k = 0; k < w->def.n_cloths; k++)
        r.seconds[DRAPE_PART_SOLVER] += w->sheet[k].solver.seconds;
    step_charge(&r, DRAPE_PART_INTEGRATION, last, r.seconds[DRAPE_PART_SOLVER]);
    bool diverged = r.outcome & DRAPE_DIVERGED;
    if (diverged)
        again = slice_diverged(w);
    if (status == DRAPE_OK && !diverged && w->plan.collides) {
        status = collide_far(w, &r, last, &again); /* 26 travel */
        if (status == DRAPE_OK && !again)
            status = collide(w, &r, last); /* 20 refit … 37 response */
    }
    if (status == DRAPE_OK && !diverged && !again)
        judge(w, &r, &again);
    slice_report(all, &r, !again);
    if (status != DRAPE_OK || diverged || again)
        return status;
    bool doubt = ending_doubtful(w, r.outcome);
    if (w->slicing.done == 0 && (w->slicing.level > 0 || doubt))
        status = slice_save(w);
    if (status == DRAPE_OK)
        commit(w, r.outcome);
    return status;
}

static int pipeline(struct world *w, drape_step_report *r)
{
    double last = clock_now(), energy[3] = {0};
    int status = DRAPE_OK;
    w->trace.step = w->step;
    w->trace.last = last;
    slice_begin(w);
    if (w->asleep && w->plan.led)
        status = lead(w, slice_time(w), w->x1);
    if (status != DRAPE_OK)
        return status;
    bool asleep = w->asleep && !lead_moves(w);
    if (asleep)
        r->outcome = DRAPE_ASLEEP;
    while (!asleep && status == DRAPE_OK && !slice_last(w) &&
           !(r->outcome & DRAPE_DIVERGED))
        status = slice(w, r, &last);
    bool diverged = r->outcome & DRAPE_DIVERGED;
    bool moved = status == DRAPE_OK && !diverged && !asleep;
    int64_t found = w->intersecting;
    if (moved && ending_doubtful(w, r->outcome))
        status = ending_count(w, &found); /* 40 audit */
    bool failed = status != DRAPE_OK || diverged;
    if (failed && w->slicing.done > 0)
        slice_restore(w);
    if (status != DRAPE_OK)
        return status;
    w->intersecting = found;
    ending_tell(w, r);
    if (!failed && !asleep)
        slice_end(w);
    w->step += !failed;
    w->time = (double)w->step * w->def.dt;
    if (failed || asleep) {
        weigh(w, w->x0, w->v0, energy);
        tell(r, energy);
    }
    r->step = w->step;
    r->time = w->time;
    return DRAPE_OK;
}

int step_advance(struct world *w, drape_step_report *report)
{
    drape_step_report unread;
    w->reported = report != NULL;
    report = report ? report : &unread;
    memset(report, 0, sizeof *report);
    /* waking threads costs more than a small scene's loops */
    bool small = w->nv < SMALL_SCENE;
    struct threads threads;
    threads_begin(&threads, small ? 1 : w->def.threads);
    int status = pipeline(w, report);
    threads_end(&threads);
    return status;
}
