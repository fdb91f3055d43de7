/* SPDX-License-Identifier: Apache-2.0 */
/* The explicit methods as sequences of the stages springs and advance. Without
 * a trace, the force and the updates that use it are one kernel, and many
 * substeps are a loop that runs on the device. spec/cloth/advance.md §2,
 * spec/gpu.md §13 */
#include "gpu/cloth/advance.cuh"
#include "gpu/cloth/motion.cuh"
#include "gpu/cloth/springs.cuh"
#include "gpu/run/loop.cuh"

extern "C" {
#include "ref/cloth/dynamics.h"
}

/* Substeps of one iteration of the device's loop. The number is even, so that
 * every iteration begins with the same streams. */
#ifdef __CUDACC__
enum { UNROLLED = 32 };
#else
enum { UNROLLED = 4 };
#endif

/* Positions and velocities at one point of a method. */
struct state {
    vec *x, *v;
};

/* The current substep, of n: number k, or number k of the current iteration of
 * the device's loop. */
struct moment {
    int32_t k, n, iterations;
    const int32_t *left; /* device: iterations left, or NULL outside a loop */
};

/* A cloth in a substep of length h, which takes it from `now` to `next`. more
 * and spare: memory for states between. */
struct walk_on {
    struct gpu *g;
    struct sheet *s;
    struct state now, next, more, spare;
    real h;
    struct moment when;
};

/* An update by a force: x moves by a·rate and v by b·force / mass, from state
 * `from` to state `to`. rate NULL: symplectic. node: the time of the result
 * within the substep, 0 … 1, for pins. */
struct use {
    struct state from;
    const vec *rate;
    struct state to;
    real a, b;
    double node;
};

/* The time within the step, 0 … 1. The last substep ends at exactly 1, so the
 * pins end exactly at their targets. */
static __host__ __device__ real place(struct moment m, double node)
{
    int32_t k =
        m.k + (m.left ? (m.iterations - *m.left) * (int32_t)UNROLLED : 0);
    double n = m.n, start = k / n;
    double length = k + 1 < m.n ? (k + 1) / n - start : 1 - start;
    return (real)(start + node * length);
}

static struct advance update(const struct walk_on *w, const struct use *u)
{
    const struct cloth *c = &w->s->cloth;
    const struct dynamics *d = &w->s->dynamics;
    struct advance a = {};
    a.count = c->count;
    a.fixed = c->fixed;
    a.mass = c->mass;
    a.x = u->from.x;
    a.v = u->from.v;
    a.rate = u->rate ? u->rate : u->from.v;
    a.force = motion_stream(w->s, 0);
    a.symplectic = !u->rate;
    a.a = u->a;
    a.b = u->b;
    a.from = d->x;
    a.to = d->to;
    a.dt = (real)d->dt;
    a.x1 = u->to.x;
    a.v1 = u->to.v;
    return a;
}

namespace
{

/* What the springs kernel does with a force: one or two updates of the
 * particle, one after the other. */
struct updates {
    int n;
    struct advance of[2];
    double node[2];
    struct moment when;
    __device__ void take(int p, vec force) const
    {
        for (int k = 0; k < n; k++) {
            bool pinned = of[k].fixed[p] == CLOTH_PINNED;
            real at = pinned ? place(when, node[k]) : 0;
            advance_particle(&of[k], p, force, at);
        }
    }
};

} // namespace

/* The force and its updates as separate stages, which a trace shows. */
static void show(struct walk_on *w, struct state at, int n,
                 const struct use *use)
{
    gpu_motion_force(w->g, w->s, at.x, at.v, at.v);
    for (int k = 0; k < n; k++) {
        struct advance a = update(w, &use[k]);
        a.at = place(w->when, use[k].node);
        gpu_advance(w->g, &a);
        motion_trace(w->g, w->s, "advance", a.v1);
    }
}

/* Computes the force at a state and applies n ≤ 2 updates with it. No update
 * may write that state, since other blocks still read it. */
static void force(struct walk_on *w, struct state at, int n,
                  const struct use *use)
{
    if (w->s->dynamics.trace) {
        show(w, at, n, use);
        return;
    }
    struct updates to = {};
    to.n = n;
    to.when = w->when;
    for (int k = 0; k < n; k++) {
        to.of[k] = update(w, &use[k]);
        to.node[k] = use[k].node;
    }
    struct springs f = gpu_motion_springs(w->g, w->s, at.x, at.v, at.v);
    springs_to<0>(w->g, &f, to);
}

static void step_euler(struct walk_on *w)
{
    struct use full = {w->now, NULL, w->next, w->h, w->h, 1};
    force(w, w->now, 1, &full);
}

static void step_midpoint(struct walk_on *w)
{
    struct state mid = w->more;
    real h = w->h;
    struct use half = {w->now, w->now.v, mid, h / 2, h / 2, 0.5};
    struct use full = {w->now, mid.v, w->next, h, h, 1};
    force(w, w->now, 1, &half);
    force(w, mid, 1, &full);
}

/* The second force is evaluated at the velocity that the first force
 * predicts. */
static void step_verlet(struct walk_on *w)
{
    struct state next = w->next, ahead = w->more;
    real h = w->h;
    struct use start[2] = {{w->now, NULL, next, h, h / 2, 1},
                           {next, next.v, ahead, 0, h / 2, 1}};
    struct use kick = {next, next.v, next, 0, h / 2, 1};
    force(w, w->now, 2, start);
    force(w, ahead, 1, &kick);
}

static void runge_kutta(struct walk_on *w)
{
    static const double weight[4] = {1.0 / 6, 1.0 / 3, 1.0 / 3, 1.0 / 6};
    static const double node[4] = {0.5, 0.5, 1, 1};
    struct state at = w->now, sum = w->now;
    for (int k = 0; k < 4; k++) {
        struct state ahead = k == 1 ? w->spare : w->more;
        real part = (real)weight[k] * w->h, go = (real)node[k] * w->h;
        struct use use[2] = {{sum, at.v, w->next, part, part, 1},
                             {w->now, at.v, ahead, go, go, node[k]}};
        force(w, at, k < 3 ? 2 : 1, use);
        sum = w->next;
        at = ahead;
    }
}

/* Makes the result of a substep the start of the next. */
static void swap(struct walk_on *w)
{
    struct state old = w->now;
    w->now = w->next;
    w->next = old;
}

/* Queues the launches of some substeps, beginning with w's. */
static int queue(struct walk_on w, int32_t substeps)
{
    int method = w.s->dynamics.method;
    for (int32_t k = 0; k < substeps; k++) {
        if (method == DRAPE_EULER)
            step_euler(&w);
        else if (method == DRAPE_MIDPOINT)
            step_midpoint(&w);
        else if (method == DRAPE_VERLET)
            step_verlet(&w);
        else
            runge_kutta(&w);
        swap(&w);
        w.when.k++;
    }
    return gpu_status(w.g);
}

/* Everything that the launches of substeps depend on: the key of a captured
 * graph. */
struct walk_key {
    struct walk_on w;
    struct dynamics d;
    int32_t substeps;
};

static void write_key(struct walk_key *key, const struct walk_on *w,
                      int32_t substeps)
{
    memset((void *)key, 0, sizeof *key); /* padding, too */
    memcpy((void *)&key->w, (const void *)w, sizeof key->w);
    memcpy((void *)&key->d, (const void *)&w->s->dynamics, sizeof key->d);
    /* The launches do not read the members that follow. */
    key->d.reference = key->d.surplus = 0;
    memset(key->d.before, 0, sizeof key->d.before);
    memset(key->d.energy, 0, sizeof key->d.energy);
    key->substeps = substeps;
}

/* Runs the first substeps, those that do not fill an iteration of the loop. */
static void queue_rest(struct walk_on *w, int32_t substeps)
{
    struct walk_key key;
    auto launch = [&] { return queue(*w, substeps); };
    if (!substeps)
        return;
    write_key(&key, w, substeps);
    if (w->s->dynamics.trace ||
        !gpu_loop(w->g, loop_key{&key, sizeof key}, {NULL, launch, {}, {}}))
        launch();
    if (substeps % 2)
        swap(w);
    w->when.k += substeps;
}

/* One thread sets the number of iterations left. */
KERNEL iterations_kernel(int32_t *left, int32_t iterations)
{
    *left = iterations;
}

/* One thread counts one iteration as done. */
KERNEL turn_kernel(int32_t *left)
{
    *left = *left - 1;
}

/* Runs `iterations` iterations of UNROLLED substeps, as a loop on the device if
 * it has such loops. */
static void iterate(struct walk_on *w, int32_t iterations)
{
    struct walk_key key;
    int32_t *left = (int32_t *)gpu_words(w->g);
    w->when.iterations = iterations;
    w->when.left = left;
    auto launch = [&] {
        int status = queue(*w, UNROLLED);
        LAUNCH_BLOCKS(w->g, 1, 1, turn_kernel, left);
        return status;
    };
    write_key(&key, w, UNROLLED);
    LAUNCH_BLOCKS(w->g, 1, 1, iterations_kernel, left, iterations);
    if (gpu_loop(w->g, loop_key{&key, sizeof key}, {left, {}, launch, {}}))
        return;
    for (int32_t k = 0; k < iterations && gpu_status(w->g) == DRAPE_OK; k++)
        launch();
}

int gpu_motion_explicit(struct gpu *g, struct sheet *s)
{
    struct dynamics *d = &s->dynamics;
    const struct cloth *c = &s->cloth;
    int32_t n = advance_substeps_of(d->method, d->dt, c);
    d->substeps = n;
    if (n > d->max_substeps)
        return DRAPE_ELIMIT;
    struct walk_on w = {};
    w.g = g;
    w.s = s;
    w.now = {d->x1, d->v1};
    w.next = {motion_stream(s, 1), motion_stream(s, 2)};
    w.more = w.spare = {motion_stream(s, 3), motion_stream(s, 4)};
    if (!d->trace && motion_spares(d)) /* the stream of forces is then free */
        w.spare = {motion_stream(s, 0), motion_stream(s, (int)motion_vecs(d))};
    w.h = (real)(d->dt / n);
    w.when.n = n;
    int32_t iterations = d->trace ? 0 : n / UNROLLED;
    gpu_motion_copy(g, s, d->x, d->v);
    queue_rest(&w, n - iterations * UNROLLED);
    if (iterations)
        iterate(&w, iterations);
    gpu_motion_copy(g, s, w.now.x, w.now.v);
    return gpu_status(g);
}
