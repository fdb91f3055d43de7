/* SPDX-License-Identifier: Apache-2.0 */
/* Handles contact in one slice of a step, for either backend: measures how far
 * candidates move, pushes close pairs apart, and resolves penetrations.
 * spec/world/step.md §3, §7 */
#include "ref/world/collide.h"

#include "ref/base/clock.h"
#include "ref/broad/travel.h"
#include "ref/contact/response.h"
#include "ref/sleep/sleep.h"
#include "ref/world/slice.h"

/* §3.1: contacts whose pairs are so many times their thickness apart take part
 * in a solve; a pair at rest is at its thickness, more or less. */
static const real RANGE = R(1.25);

static void give_pairs(const struct world *w, struct pairs *out)
{
    out->n = w->sleep->woken ? 0 : w->broad.n; /* the slice is taken again */
    out->pair = w->broad.pair.data;
    out->kind = w->broad.kind.data;
}

int collide_broad(void *user, const uint8_t *touched, struct pairs *out)
{
    struct world *w = user;
    double start = clock_now();
    real r = touched ? 0 : w->response.reach;
    int status = broad_query(&w->broad, w->x0, w->x1, r, touched);
    if (status == DRAPE_OK)
        status = sleep_notice(w);
    w->broad_seconds += clock_now() - start;
    give_pairs(w, out);
    return status;
}

/* Charges the time since *last to a part of the report. The time that the broad
 * phase and the solves with contacts took meanwhile goes to their own parts. */
static void charge_contact(struct world *w, drape_step_report *r,
                           enum drape_part part, double *last)
{
    slice_charge(w, r, part, last, w->broad_seconds + w->lagrange.seconds);
    r->seconds[DRAPE_PART_BROAD] += w->broad_seconds;
    r->seconds[DRAPE_PART_SOLVER] += w->lagrange.seconds;
    w->broad_seconds = w->lagrange.seconds = 0;
    slice_count(&r->work, &w->broad);
}

/* Queries the broad phase for pairs that may come within r on the way from x0
 * to `to`. If the slice before found nothing near, whole meshes are tested
 * first, and the query is skipped if they are apart. */
static int find_near(struct world *w, const vec *to, real r)
{
    double start = clock_now();
    bool apart = false;
    int status = DRAPE_OK;
    if (w->nearness == NEAR_NONE)
        status = broad_meshes_apart(&w->broad, w->x0, to, r, &apart);
    if (status == DRAPE_OK && !apart)
        status = broad_query(&w->broad, w->x0, to, r, NULL);
    if (status == DRAPE_OK && !apart)
        status = sleep_notice(w);
    w->broad_seconds += clock_now() - start;
    return status;
}

/* §7.2. Candidates are measured only if the largest displacement of a vertex
 * allows two vertices to move too far relative to each other: twice as far,
 * hence the factor 4 of the square. */
int collide_far(struct world *w, drape_step_report *r, double *last,
                bool *again)
{
    *again = slice_too_far(
        w, 4 * w->run->prescribed_furthest(w->on, w->nv, w->x0, w->x1));
    if (!*again)
        return w->run->status(w->on);
    int status = find_near(w, w->x1, 0);
    struct travel t = {.nv = w->nv,
                       .n = w->broad.n,
                       .pair = w->broad.pair.data,
                       .kind = w->broad.kind.data,
                       .x0 = w->x0,
                       .x1 = w->x1};
    if (status == DRAPE_OK && t.n) {
        status = w->run->travel(w->on, &t);
        trace_stage(w->tracing, "travel", &t.most, sizeof t.most);
    }
    *again = slice_too_far(w, t.most);
    if (*again)
        slice_cut(w);
    charge_contact(w, r, DRAPE_PART_PROXIMITY, last);
    return status;
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
    r->work.near = c->close;
    r->work.later = c->later;
    r->work.narrow = c->narrow;
}

static int start_contacts(struct world *w)
{
    struct response *c = &w->response;
    c->x0 = w->x0;
    c->x1 = w->x1;
    c->v = w->v1;
    c->dt = (real)w->dt;
    c->stop_before_zones = slice_can_retry(w);
    c->max_rounds = slice_rounds(w);
    c->solves = w->plan.solves;
    c->seams = seams_contacts(&w->seams);
    c->range = w->plan.solves ? RANGE : 1;
    return response_start(c);
}

/* §3.1: the pairs that are close at the start of the slice are pushed apart:
 * within the solve of all cloths, or by themselves. */
static int repel_pairs(struct world *w)
{
    int status = start_contacts(w);
    if (status == DRAPE_OK)
        status = find_near(w, w->x0, w->response.range * w->reach);
    struct pairs close = {w->broad.n, w->broad.pair.data, w->broad.kind.data};
    if (status != DRAPE_OK || w->sleep->woken)
        return status;
    return w->plan.solves ? lagrange_solve(w, &close)
                          : response_repel(&w->response, &close);
}

/* Sets *alone if no pair comes within reach during the slice, so that the rest
 * of the slice's contact is skipped. This is tested only if the slice before
 * found nothing near. */
static int test_alone(struct world *w, bool *alone)
{
    response_reset(&w->response);
    *alone = false;
    if (w->nearness != NEAR_NONE || w->seams.n > 0)
        return DRAPE_OK;
    int status = find_near(w, w->x1, RANGE * w->reach);
    *alone = w->broad.n == 0;
    return status;
}

/* Reports the work of the loop that solves contacts. */
static void count_solves(const struct world *w, drape_step_report *r)
{
    const struct lagrange *a = &w->lagrange;
    if (!a->solved)
        return;
    r->iterations += a->iterations;
    r->work.solves += a->solves;
    r->residual = fmax(r->residual, a->residual);
}

int collide_slice(struct world *w, drape_step_report *r, double *last)
{
    bool alone;
    int status = test_alone(w, &alone);
    if (status == DRAPE_OK && !alone)
        status = repel_pairs(w);
    charge_contact(w, r, DRAPE_PART_PROXIMITY, last);
    w->met = !alone;
    if (status != DRAPE_OK || alone || w->sleep->woken)
        return status;
    r->outcome |= w->lagrange.solved ? w->lagrange.outcome : 0;
    if (r->outcome & DRAPE_DIVERGED)
        return status;
    status = response_penetrate(&w->response);
    charge_contact(w, r, DRAPE_PART_PENETRATION, last);
    count_contacts(&w->response, r);
    count_solves(w, r);
    return status;
}
