/* SPDX-License-Identifier: Apache-2.0 */
/* The pipeline of one step; step_advance is its table of contents.
 * spec/00_step.md */
#include "ref/step.h"

#include <stdio.h>

#include "ref/advance.h"
#include "ref/clock.h"
#include "ref/implicit.h"
#include "ref/lead.h"
#include "ref/threads.h"

enum { REST_STEPS = 30, SMALL_SCENE = 4096 };
static const double REST_PART = 1e-3; /* of the thickness, a step */

/* ---- §1 Time ---- */

/* Adds the time since *last to a part of the report, but for the seconds
 * within that are another part's. */
static void charge(drape_step_report *r, enum drape_part part, double *last,
                   double within)
{
    double t = clock_now();
    r->seconds[part] += t - *last - within;
    *last = t;
}

/* ---- §3 Motion without contact ---- */

static int move_sheet(struct world *w, int k, drape_step_report *r)
{
    struct sheet *s = &w->sheet[k];
    struct dynamics *d = &s->dynamics;
    d->x = w->x0 + s->first;
    d->v = w->v0 + s->first;
    d->xp = w->past_x ? w->past_x + s->first : NULL;
    d->vp = w->past_v ? w->past_v + s->first : NULL;
    d->has_past = w->has_past;
    d->to = w->to + s->first;
    d->x1 = w->x1 + s->first;
    d->v1 = w->v1 + s->first;
    d->reference = w->watch[k][0];
    d->surplus = w->watch[k][1];
    d->iterations = 0;
    d->residual = 0;
    d->outcome = 0;
    int status = ref_dynamics(d);
    if (status != DRAPE_OK)
        return status;
    r->outcome |= d->outcome;
    r->iterations += d->iterations;
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

/* ---- §4 Contact ---- */

int step_broad(void *user, const uint8_t *touched, struct pairs *out)
{
    struct world *w = user;
    double start = clock_now();
    int status = broad_query(&w->broad, w->x0, w->x1, 0, touched);
    w->broad_seconds += clock_now() - start;
    out->n = w->broad.n;
    out->pair = w->broad.pair.data;
    out->kind = w->broad.kind.data;
    return status;
}

int step_grow(void *user, struct pool *pool, int64_t need, size_t size)
{
    struct world *w = user;
    need += need / 4 + 64; /* so that growth is rare */
    void *p = arena_take(w->arena, ARENA_RESPONSE, need, size);
    if (!p)
        return DRAPE_ENOMEM;
    arena_give(w->arena, pool->data);
    pool->data = p;
    pool->cap = need;
    return DRAPE_OK;
}

/* Pairs within reach of each other where the step starts are pushed apart. */
static int repel(struct world *w)
{
    double start = clock_now();
    int status = broad_query(&w->broad, w->x0, w->x0, w->reach, NULL);
    w->broad_seconds += clock_now() - start;
    if (status != DRAPE_OK)
        return status;
    struct pairs near = {w->broad.n, w->broad.pair.data, w->broad.kind.data};
    return ref_response_repel(&w->response, &near);
}

static void count_contacts(const struct response *c, drape_step_report *r)
{
    r->outcome |= c->outcome;
    r->rounds = c->rounds;
    r->contacts = c->contacts;
    r->impacts = c->impacts;
    r->candidates = c->candidates;
    r->zone_vertices = c->zone_vertices;
    r->rolled_back = c->rolled_back;
}

/* Broad phase and coupled solves within it are parts of their own. */
static void charge_contact(struct world *w, drape_step_report *r,
                           enum drape_part part, double *last)
{
    charge(r, part, last, w->broad_seconds + w->couple.seconds);
    r->seconds[DRAPE_PART_BROAD] += w->broad_seconds;
    r->seconds[DRAPE_PART_SOLVER] += w->couple.seconds;
    w->broad_seconds = w->couple.seconds = 0;
}

static int collide(struct world *w, drape_step_report *r, double *last)
{
    struct response *c = &w->response;
    c->x0 = w->x0;
    c->x1 = w->x1;
    c->v = w->v1;
    int status = ref_response_start(c);
    if (w->plan.implicit)
        couple_start(w);
    if (status == DRAPE_OK)
        status = repel(w);
    charge_contact(w, r, DRAPE_PART_PROXIMITY, last);
    if (status == DRAPE_OK)
        status = ref_response_penetrate(c);
    charge_contact(w, r, DRAPE_PART_PENETRATION, last);
    count_contacts(c, r);
    r->iterations += w->couple.iterations;
    return status;
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
                        .dt = (real)w->def.dt,
                        .xp = w->past_x,
                        .vp = w->past_v};
    ref_history(&h);
    trace_stage(w->tracing, "history", w->past_v,
                (size_t)w->nc * sizeof *w->past_v);
    w->has_past = true;
}

/* §6: whether no particle went further than a part of the thickness. */
static bool rests(const struct world *w)
{
    real most = (real)REST_PART * w->reach;
    for (int64_t i = 0; i < w->nc; i++) {
        vec d = vec_sub(w->x1[i], w->x0[i]);
        if (!(vec_dot(d, d) <= most * most))
            return false;
    }
    return true;
}

static void commit(struct world *w)
{
    if (w->plan.history)
        remember(w);
    w->resting = w->def.sleep && rests(w) ? w->resting + 1 : 0;
    w->asleep = w->resting >= REST_STEPS;
    for (int k = 0; k < w->def.n_cloths; k++) {
        w->watch[k][0] = w->sheet[k].dynamics.reference;
        w->watch[k][1] = w->sheet[k].dynamics.surplus;
    }
    vec *x = w->x0, *v = w->v0;
    w->x0 = w->x1;
    w->v0 = w->v1;
    w->x1 = x;
    w->v1 = v;
    w->step++;
    w->time = (double)w->step * w->def.dt;
}

/* Energies where the step ended, all cloths. */
static void weigh(const struct world *w, drape_step_report *r)
{
    for (int k = 0; k < w->def.n_cloths; k++) {
        double value[3];
        dynamics_energy(&w->sheet[k].dynamics, w->x0 + w->sheet[k].first,
                        w->v0 + w->sheet[k].first, value);
        r->kinetic += value[0];
        r->elastic += value[1];
        r->potential += value[2];
    }
    r->step = w->step;
    r->time = w->time;
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

static int pipeline(struct world *w, drape_step_report *r)
{
    double last = clock_now();
    double end = (double)(w->step + 1) * w->def.dt;
    w->trace.step = w->step;
    w->trace.last = last;
    int status = lead(w, end, w->x1); /* 01 kinematics */
    trace_stage(w->tracing, "kinematics", w->x1 + w->nc,
                (size_t)(w->nv - w->nc) * sizeof *w->x1);
    if (status != DRAPE_OK)
        return status;
    if (w->asleep && !lead_moves(w)) {
        r->outcome = DRAPE_ASLEEP;
        w->step++;
        w->time = end;
        weigh(w, r);
        return DRAPE_OK;
    }
    status = move(w, r); /* 03 wind … 09 dynamics, 10 sum … 15 pcg */
    for (int k = 0; k < w->def.n_cloths; k++)
        r->seconds[DRAPE_PART_SOLVER] += w->sheet[k].solver.seconds;
    charge(r, DRAPE_PART_INTEGRATION, &last, r->seconds[DRAPE_PART_SOLVER]);
    if (status != DRAPE_OK)
        return status;
    if (!(r->outcome & DRAPE_DIVERGED)) {
        if (w->plan.collides)
            status = collide(w, r, &last); /* 20 refit … 37 response */
        if (status != DRAPE_OK)
            return status;
        commit(w);
    }
    weigh(w, r);
    return DRAPE_OK;
}

int step_advance(struct world *w, drape_step_report *report)
{
    memset(report, 0, sizeof *report);
    /* waking threads costs more than a small scene's loops */
    bool small = w->nv < SMALL_SCENE;
    int threads = threads_set(small ? 1 : w->def.threads);
    int status = pipeline(w, report);
    threads_set(threads);
    return status;
}
