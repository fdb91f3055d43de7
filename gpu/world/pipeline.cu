/* SPDX-License-Identifier: Apache-2.0 */
/* The pipeline of one step on the device: ref/world/step.c again, with streams
 * that stay there. spec/world/step.md, spec/gpu.md §6 */
#include "gpu/cloth/motion.cuh"
#include "gpu/run/tape.cuh"
#include "gpu/world/collide.cuh"

enum { REST_STEPS = 30 };
static const double REST_PART = 1e-3; /* of the thickness, a step */

/* ---- §3 Motion without contact ---- */

static int move_sheet(struct gpu_world *w, int k, drape_step_report *r)
{
    struct gpu_sheet *s = &w->sheet[k];
    struct dynamics *d = &s->dynamics;
    struct world *h = w->host;
    d->x = w->x0 + s->first;
    d->v = w->v0 + s->first;
    d->xp = w->past_x ? w->past_x + s->first : NULL;
    d->vp = w->past_v ? w->past_v + s->first : NULL;
    d->dt = h->dt;
    d->has_past = state_has_past(h);
    d->to = w->to ? w->to + s->first : NULL;
    d->x1 = w->x1 + s->first;
    d->v1 = w->v1 + s->first;
    d->reference = h->watch[k][0];
    d->surplus = h->watch[k][1];
    d->iterations = 0;
    d->residual = 0;
    d->outcome = 0;
    w->couple.rough = couple_prepare(h, &s->pcg);
    d->press = state_warm(h) ? w->press + s->first : NULL;
    int status = gpu_motion(w->gpu, s);
    if (slice_weighs(h))
        gpu_keep(w->gpu, s, MOTION_BEFORE);
    if (status != DRAPE_OK)
        return status;
    r->outcome |= d->outcome;
    r->iterations += d->iterations;
    r->work.solves += h->plan.implicit;
    r->residual = d->residual > r->residual ? d->residual : r->residual;
    r->substeps = d->substeps > r->substeps ? d->substeps : r->substeps;
    return DRAPE_OK;
}

static int move(struct gpu_world *w, drape_step_report *r)
{
    const struct plan *plan = &w->host->plan;
    size_t bytes = (size_t)w->host->nc * sizeof *w->x1;
    int status = DRAPE_OK;
    for (int k = 0; k < w->host->def.n_cloths && status == DRAPE_OK; k++)
        status = move_sheet(w, k, r);
    if (status != DRAPE_OK)
        return status;
    if (plan->led)
        gpu_lead_velocities(w);
    if (plan->history && plan->collides) {
        gpu_copy(w->gpu, w->free_x, w->x1, bytes);
        gpu_copy(w->gpu, w->free_v, w->v1, bytes);
    }
    return gpu_status(w->gpu);
}

/* ---- §5 The end of a step ---- */

static void remember(struct gpu_world *w)
{
    struct world *h = w->host;
    bool collides = h->plan.collides;
    struct history s = {.count = h->nc,
                        .x0 = w->x0,
                        .v0 = w->v0,
                        .x1 = collides ? w->free_x : w->x1,
                        .v1 = collides ? w->free_v : w->v1,
                        .x = w->x1,
                        .v = w->v1,
                        .dt = (real)h->dt,
                        .xp = w->past_x,
                        .vp = w->past_v};
    gpu_history(w->gpu, &s);
    gpu_trace(w->gpu, h->tracing, "history", w->past_v,
              (size_t)h->nc * sizeof *w->past_v);
    h->past = 1 + h->slicing.level;
}

static bool rests(struct gpu_world *w, int outcome)
{
    const struct world *h = w->host;
    real most = (real)REST_PART * h->reach;
    return h->def.sleep && !slice_failed(outcome) && h->slicing.level == 0 &&
           gpu_collide_furthest(w, h->nc) <= most * most;
}

static void keep_press(struct gpu_world *w, bool held)
{
    struct world *h = w->host;
    size_t bytes = (size_t)h->nc * sizeof *w->press;
    if (!h->plan.warm)
        return;
    if (held)
        gpu_copy(w->gpu, w->press, w->couple.press, bytes);
    else if (h->pressed)
        gpu_clear(w->gpu, w->press, bytes);
    h->pressed = held;
}

static void commit(struct gpu_world *w, int outcome)
{
    struct world *h = w->host;
    if (h->plan.history)
        remember(w);
    h->resting = rests(w, outcome) ? h->resting + 1 : 0;
    h->asleep = h->resting >= REST_STEPS;
    h->near = state_nearness(&w->response);
    keep_press(w, !slice_failed(outcome) && h->near == NEAR_CONTACTS);
    for (int k = 0; k < h->def.n_cloths; k++) {
        h->watch[k][0] = w->sheet[k].dynamics.reference;
        h->watch[k][1] = w->sheet[k].dynamics.surplus;
    }
    vec *x = w->x0, *v = w->v0;
    w->x0 = w->x1;
    w->v0 = w->v1;
    w->x1 = x;
    w->v1 = v;
    slice_keep(h);
}

static void weigh(struct gpu_world *w, const vec *x, const vec *v,
                  double energy[3])
{
    for (int k = 0; k < w->host->def.n_cloths; k++) {
        struct gpu_sheet *s = &w->sheet[k];
        double value[3];
        gpu_motion_energy(w->gpu, s, x + s->first, v + s->first, value);
        for (int j = 0; j < 3; j++)
            energy[j] += value[j];
    }
}

/* ---- The pipeline ---- */

static void tell(drape_step_report *r, const double energy[3])
{
    r->kinetic = energy[0];
    r->elastic = energy[1];
    r->potential = energy[2];
}

/* Dynamics weighed what contact has left alone. */
static void judge(struct gpu_world *w, drape_step_report *r, bool *again)
{
    struct world *h = w->host;
    double before[3] = {}, after[3] = {};
    bool anew = h->met && (h->reported || slice_weighs(h));
    for (int k = 0; k < h->def.n_cloths; k++)
        for (int j = 0; j < 3; j++) {
            before[j] += w->sheet[k].dynamics.before[j];
            after[j] += anew ? 0 : w->sheet[k].dynamics.energy[j];
        }
    if (anew)
        weigh(w, w->x1, w->v1, after);
    tell(r, after);
    *again = h->plan.collides && slice_wrong(h, r->outcome, before, after);
}

/* ---- A slice as one graph, §13 ---- */

/* What the launches of a slice depend on, besides what looks show. */
struct slice_key {
    const vec *x0, *v0;
    real dt;
    int32_t level, near, rounds; /* rounds, near: of the slice before */
    uint8_t first, brief, warm, pressed, past, reported, started, front;
};

/* Whether no launch depends on more than that. */
static bool fits(const struct gpu_world *w)
{
    const struct world *h = w->host;
    return !h->tracing && !h->intersecting && h->def.solver == DRAPE_EXACT &&
           h->def.n_cloths < TAPE_TOLD - 1;
}

static void begin_tape(struct gpu_world *w)
{
    const struct world *h = w->host;
    int64_t told[TAPE_TOLD];
    struct slice_key key;
    if (!fits(w))
        return;
    memset((void *)&key, 0, sizeof key); /* what lies between, too */
    key.x0 = w->x0;
    key.v0 = w->v0;
    key.dt = (real)h->dt;
    key.level = h->slicing.level;
    key.near = h->near;
    key.rounds = w->response.rounds;
    key.first = h->slicing.done == 0;
    key.brief = slice_brief(h);
    key.warm = state_warm(h);
    key.pressed = h->pressed;
    key.past = state_has_past(h);
    key.reported = h->reported;
    key.started = w->broad.started;
    key.front = w->broad.n_front > 0;
    for (int k = 0; k < h->def.n_cloths; k++) {
        double may = gpu_motion_may_gain(&w->sheet[k], h->watch[k]);
        memcpy(&told[k], &may, sizeof may);
    }
    told[h->def.n_cloths] = w->broad.n_front;
    gpu_tape_begin(w->gpu, tape_key{&key, sizeof key}, told,
                   h->def.n_cloths + 1);
}

/* One slice of a step, from the state to the state, or to a shorter slice. */
static int slice(struct gpu_world *w, drape_step_report *all, double *last)
{
    struct world *h = w->host;
    drape_step_report r = {};
    bool again = false;
    h->met = false;
    int status = gpu_lead(w, slice_time(h), w->x1); /* 01 kinematics */
    gpu_trace(w->gpu, h->tracing, "kinematics", w->x1 + h->nc,
              (size_t)(h->nv - h->nc) * sizeof *w->x1);
    if (status == DRAPE_OK)
        begin_tape(w);
    if (status == DRAPE_OK)
        status = move(w, &r); /* 03 wind … 09 dynamics, 10 sum … 15 pcg */
    for (int k = 0; k < h->def.n_cloths; k++)
        r.seconds[DRAPE_PART_SOLVER] += w->sheet[k].solver_seconds;
    gpu_charge(w, &r, DRAPE_PART_INTEGRATION, last,
               r.seconds[DRAPE_PART_SOLVER]);
    bool diverged = r.outcome & DRAPE_DIVERGED;
    if (diverged)
        again = slice_diverged(h);
    if (status == DRAPE_OK && !diverged && h->plan.collides) {
        status = gpu_collide_far(w, &r, last, &again); /* 26 travel */
        if (status == DRAPE_OK && !again)
            status = gpu_collide(w, &r, last); /* 20 refit … 37 response */
    }
    if (status == DRAPE_OK && !diverged && !again)
        judge(w, &r, &again);
    slice_report(all, &r, !again);
    if (status != DRAPE_OK || diverged || again)
        return status;
    gpu_fence(w->gpu);
    bool doubt = ending_doubtful(h, r.outcome);
    if (h->slicing.done == 0 && (h->slicing.level > 0 || doubt))
        status = gpu_slice_save(w);
    if (status == DRAPE_OK)
        commit(w, r.outcome);
    return status;
}

static int pipeline(struct gpu_world *w, drape_step_report *r)
{
    struct world *h = w->host;
    double last = clock_now(), energy[3] = {};
    int status = DRAPE_OK;
    h->trace.step = h->step;
    h->trace.last = last;
    slice_begin(h);
    if (h->asleep && h->plan.led)
        status = gpu_lead(w, slice_time(h), w->x1);
    if (status != DRAPE_OK)
        return status;
    bool asleep = h->asleep && !gpu_lead_moves(w);
    if (asleep)
        r->outcome = DRAPE_ASLEEP;
    while (!asleep && status == DRAPE_OK && !slice_last(h) &&
           !(r->outcome & DRAPE_DIVERGED)) {
        status = slice(w, r, &last);
        gpu_tape_done(w->gpu); /* whatever became of it */
    }
    bool diverged = r->outcome & DRAPE_DIVERGED;
    bool moved = status == DRAPE_OK && !diverged && !asleep;
    int64_t found = h->intersecting;
    if (moved && ending_doubtful(h, r->outcome))
        status = gpu_ending_count(w, &found); /* 40 audit */
    bool failed = status != DRAPE_OK || diverged;
    if (failed && h->slicing.done > 0)
        gpu_slice_restore(w);
    if (status != DRAPE_OK)
        return status;
    h->intersecting = found;
    ending_tell(h, r);
    if (!failed && !asleep)
        slice_end(h);
    h->step += !failed;
    h->time = (double)h->step * h->def.dt;
    if (failed || asleep) {
        weigh(w, w->x0, w->v0, energy);
        tell(r, energy);
    }
    r->step = h->step;
    r->time = h->time;
    return gpu_status(w->gpu);
}

int gpu_step(struct world *h, drape_step_report *r)
{
    drape_step_report unread;
    h->reported = r != NULL;
    r = r ? r : &unread;
    memset(r, 0, sizeof *r);
    gpu_begin(h->device->gpu);
    return pipeline(h->device, r);
}
