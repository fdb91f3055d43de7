/* SPDX-License-Identifier: Apache-2.0 */
/* The explicit methods as sequences of springs and advance.
 * spec/06_advance.md §2 */
#include "gpu/motion.cuh"

/* A state that a method passes through. */
struct state {
    vec *x, *v;
};

/* A substep: its length and where in the step it starts and ends. */
struct span {
    real h;
    double start, length;
};

/* A cloth in one substep: next and more are streams of work. */
struct walk_on {
    struct gpu *g;
    struct gpu_sheet *s;
    struct state now, next, more;
};

/* How a result is made: position by a, velocity by b, pins at `at`. */
struct spans {
    real a, b;
    double at;
};

/* to = from + a·rate, from + b·force / mass; no rate: symplectic. */
static void advance(struct walk_on *w, struct state from, const vec *rate,
                    struct state to, struct spans by)
{
    const struct cloth *c = &w->s->cloth;
    const struct dynamics *d = &w->s->dynamics;
    struct advance a = {};
    a.count = c->count;
    a.fixed = c->fixed;
    a.mass = c->mass;
    a.x = from.x;
    a.v = from.v;
    a.rate = rate ? rate : from.v;
    a.force = motion_stream(w->s, 0);
    a.symplectic = !rate;
    a.a = by.a;
    a.b = by.b;
    a.from = d->x;
    a.to = d->to;
    a.at = (real)by.at;
    a.dt = (real)d->dt;
    a.x1 = to.x;
    a.v1 = to.v;
    gpu_advance(w->g, &a);
    motion_trace(w->g, w->s, "advance", a.v1);
}

static void force(struct walk_on *w, struct state at)
{
    gpu_motion_force(w->g, w->s, at.x, at.v, at.v);
}

static void euler(struct walk_on *w, struct span t)
{
    force(w, w->now);
    advance(w, w->now, NULL, w->now, spans{t.h, t.h, t.start + t.length});
}

static void midpoint(struct walk_on *w, struct span t)
{
    struct state mid = w->more;
    struct spans half = {t.h / 2, t.h / 2, t.start + t.length / 2};
    force(w, w->now);
    advance(w, w->now, w->now.v, mid, half);
    force(w, mid);
    advance(w, w->now, mid.v, w->next, spans{t.h, t.h, t.start + t.length});
}

/* The second force is at the velocity that the first one predicts. */
static void verlet(struct walk_on *w, struct span t)
{
    struct state next = w->next, ahead = w->more;
    struct spans kick = {0, t.h / 2, t.start + t.length};
    struct spans kick_drift = {t.h, t.h / 2, t.start + t.length};
    force(w, w->now);
    advance(w, w->now, NULL, next, kick_drift);
    advance(w, next, next.v, ahead, kick);
    force(w, ahead);
    advance(w, next, next.v, next, kick);
}

static void runge_kutta(struct walk_on *w, struct span t)
{
    static const double weight[4] = {1.0 / 6, 1.0 / 3, 1.0 / 3, 1.0 / 6};
    static const double node[4] = {0.5, 0.5, 1, 1};
    struct state at = w->now, sum = w->now;
    for (int k = 0; k < 4; k++) {
        real part = (real)weight[k] * t.h, go = (real)node[k] * t.h;
        force(w, at);
        advance(w, sum, at.v, w->next, spans{part, part, t.start + t.length});
        sum = w->next;
        if (k < 3)
            advance(w, w->now, at.v, w->more,
                    spans{go, go, t.start + node[k] * t.length});
        at = w->more;
    }
}

static void substep(struct walk_on *w, struct span t)
{
    int method = w->s->dynamics.method;
    if (method == DRAPE_EULER) {
        euler(w, t);
        return;
    }
    if (method == DRAPE_MIDPOINT)
        midpoint(w, t);
    else if (method == DRAPE_VERLET)
        verlet(w, t);
    else
        runge_kutta(w, t);
    struct state old = w->now;
    w->now = w->next;
    w->next = old;
}

int gpu_motion_explicit(struct gpu *g, struct gpu_sheet *s)
{
    struct dynamics *d = &s->dynamics;
    const struct cloth *c = &s->cloth;
    d->substeps = advance_substeps(d->method, d->dt, c->bound, (double)c->beta);
    if (d->substeps > d->max_substeps)
        return DRAPE_ELIMIT;
    struct walk_on w = {g,
                        s,
                        {d->x1, d->v1},
                        {motion_stream(s, 1), motion_stream(s, 2)},
                        {motion_stream(s, 3), motion_stream(s, 4)}};
    gpu_motion_copy(g, s, d->x, d->v);
    double n = d->substeps;
    for (int32_t k = 0; k < d->substeps; k++) {
        struct span t = {(real)(d->dt / n), k / n, (k + 1) / n - k / n};
        /* The last ends at exactly 1: the pins are then where they should. */
        if (k + 1 == d->substeps)
            t.length = 1 - t.start;
        substep(&w, t);
    }
    gpu_motion_copy(g, s, w.now.x, w.now.v);
    return gpu_status(g);
}
