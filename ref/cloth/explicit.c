/* SPDX-License-Identifier: Apache-2.0 */
/* The explicit methods as sequences of springs and advance.
 * spec/cloth/advance.md §2 */
#include "ref/cloth/explicit.h"

#include "ref/cloth/advance.h"
#include "ref/cloth/force.h"

/* A state that an explicit method passes through. */
struct state {
    vec *x, *v;
};

/* A substep: its length and where in the step it starts and ends. */
struct span {
    real h;
    double start, length;
};

/* to = from + a·rate, from + b·force / mass; pins at `at` of the step. */
static void advance_state(struct dynamics *s, struct state from,
                          const vec *rate, struct state to, const real ab[2],
                          double at)
{
    const struct cloth *c = s->cloth;
    struct advance a = {.count = c->count,
                        .fixed = c->fixed,
                        .mass = c->mass,
                        .x = from.x,
                        .v = from.v,
                        .rate = rate ? rate : from.v,
                        .force = force_stream(s, 0),
                        .symplectic = !rate,
                        .a = ab[0],
                        .b = ab[1],
                        .from = s->x,
                        .to = s->to,
                        .at = (real)at,
                        .dt = (real)s->dt,
                        .x1 = to.x,
                        .v1 = to.v};
    ref_advance(&a);
    force_trace(s, "advance", a.v1);
}

static void step_euler(struct dynamics *s, struct state *now, struct span t)
{
    const real full[2] = {t.h, t.h};
    force_make(s, now->x, now->v, now->v);
    advance_state(s, *now, NULL, *now, full, t.start + t.length);
}

static void step_midpoint(struct dynamics *s, struct state *now,
                          struct state *next, struct state mid, struct span t)
{
    const real half[2] = {t.h / 2, t.h / 2}, full[2] = {t.h, t.h};
    force_make(s, now->x, now->v, now->v);
    advance_state(s, *now, now->v, mid, half, t.start + t.length / 2);
    force_make(s, mid.x, mid.v, mid.v);
    advance_state(s, *now, mid.v, *next, full, t.start + t.length);
}

/* The second force is at the velocity that the first one predicts. */
static void step_verlet(struct dynamics *s, struct state *now,
                        struct state *next, struct state ahead, struct span t)
{
    const real kick_drift[2] = {t.h, t.h / 2}, kick[2] = {0, t.h / 2};
    double end = t.start + t.length;
    force_make(s, now->x, now->v, now->v);
    advance_state(s, *now, NULL, *next, kick_drift, end);
    advance_state(s, *next, next->v, ahead, kick, end);
    force_make(s, ahead.x, ahead.v, ahead.v);
    advance_state(s, *next, next->v, *next, kick, end);
}

static void runge_kutta(struct dynamics *s, struct state *now,
                        struct state *next, struct state stage, struct span t)
{
    static const double weight[4] = {1.0 / 6, 1.0 / 3, 1.0 / 3, 1.0 / 6};
    static const double node[4] = {0.5, 0.5, 1, 1};
    struct state at = *now, sum = *now;
    for (int k = 0; k < 4; k++) {
        const real add[2] = {(real)weight[k] * t.h, (real)weight[k] * t.h};
        const real go[2] = {(real)node[k] * t.h, (real)node[k] * t.h};
        force_make(s, at.x, at.v, at.v);
        advance_state(s, sum, at.v, *next, add, t.start + t.length);
        sum = *next;
        if (k < 3)
            advance_state(s, *now, at.v, stage, go,
                          t.start + node[k] * t.length);
        at = stage;
    }
}

static void make_substep(struct dynamics *s, struct state *now,
                         struct state *next, struct span t)
{
    struct state more = {force_stream(s, 3), force_stream(s, 4)};
    if (s->method == DRAPE_EULER) {
        step_euler(s, now, t);
        return;
    }
    if (s->method == DRAPE_MIDPOINT)
        step_midpoint(s, now, next, more, t);
    else if (s->method == DRAPE_VERLET)
        step_verlet(s, now, next, more, t);
    else
        runge_kutta(s, now, next, more, t);
    struct state old = *now;
    *now = *next;
    *next = old;
}

int explicit_steps(struct dynamics *s)
{
    const struct cloth *c = s->cloth;
    s->substeps = advance_substeps_of(s->method, s->dt, c);
    if (s->substeps > s->max_substeps)
        return DRAPE_ELIMIT;
    struct state now = {s->x1, s->v1},
                 next = {force_stream(s, 1), force_stream(s, 2)};
    force_copy(s, s->x, s->v);
    double n = s->substeps;
    for (int32_t k = 0; k < s->substeps; k++) {
        struct span t = {(real)(s->dt / n), k / n, (k + 1) / n - k / n};
        /* The last ends at exactly 1: the pins are then where they should. */
        if (k + 1 == s->substeps)
            t.length = 1 - t.start;
        make_substep(s, &now, &next, t);
    }
    force_copy(s, now.x, now.v);
    return DRAPE_OK;
}
