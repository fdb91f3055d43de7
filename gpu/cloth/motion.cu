/* SPDX-License-Identifier: Apache-2.0 */
/* One cloth's step without contact: each method as a sequence of stages.
 * spec/cloth/dynamics.md */
#include "gpu/cloth/motion.cuh"
#include "gpu/cloth/rate.h"

extern "C" {
#include "ref/cloth/force.h"
#include "ref/cloth/motion.h"
#include "ref/cloth/newton.h"
}

struct springs gpu_motion_springs(struct gpu *g, struct sheet *s, const vec *x,
                                  const vec *v, const vec *damping)
{
    const struct dynamics *d = &s->dynamics;
    if (d->windy) {
        struct wind w;
        force_wind(d, x, v, 0, &w);
        gpu_wind(g, &w);
        motion_trace(g, s, "wind", w.force);
    }
    struct springs f;
    force_springs(d, x, damping, &f);
    return f;
}

void gpu_motion_force(struct gpu *g, struct sheet *s, const vec *x,
                      const vec *v, const vec *damping)
{
    struct springs f = gpu_motion_springs(g, s, x, v, damping);
    gpu_springs(g, &f);
    motion_trace(g, s, "springs", f.force);
}

void gpu_motion_copy(struct gpu *g, struct sheet *s, const vec *x, const vec *v)
{
    size_t bytes = (size_t)s->cloth.count * sizeof *x;
    if (x != s->dynamics.x1)
        gpu_copy(g, s->dynamics.x1, x, bytes);
    if (v != s->dynamics.v1)
        gpu_copy(g, s->dynamics.v1, v, bytes);
}

void gpu_motion_laws(struct gpu *g, struct sheet *s)
{
    gpu_up(g, s->device->law, s->cloth.law, sizeof s->cloth.law);
    gpu_up(g, s->device->piece, s->cloth.piece, sizeof s->cloth.piece);
    gpu_up(g, s->device->triple, s->cloth.triple, sizeof s->cloth.triple);
}

/* Where the streams lie. */
static void lay_out(struct sheet *s)
{
    struct dynamics *d = &s->dynamics;
    d->law = s->device->law;
    d->piece = s->device->piece;
    d->triple = s->device->triple;
    d->force = motion_stream(s, 0);
    if (!dynamics_implicit(d->method))
        return;
    d->star = s->device->star;
    d->b = s->device->b;
    d->dv = motion_stream(s, 1);
    if (dynamics_second(d->method)) {
        d->back = motion_stream(s, 2);
        d->q = motion_stream(s, 3);
    }
}

namespace
{

/* The cloth whose motion is under way, and its device. */
struct motion {
    struct gpu *g;
    struct sheet *s;
};

} // namespace

static struct motion *motion_of(void *on)
{
    return (struct motion *)on;
}

/* STAGE(name): the stage as a function of ref/cloth/newton.h's table. */
#define STAGE(name)                                                            \
    static int go_##name(void *on, struct name *s)                             \
    {                                                                          \
        return gpu_##name(motion_of(on)->g, s);                                \
    }
STAGE(wind)
STAGE(springs)
STAGE(predict)
STAGE(rhs)
STAGE(update)
STAGE(imbalance)
STAGE(dot)

static int go_blocks(void *on, struct blocks *b)
{
    const struct motion *a = motion_of(on);
    return gpu_blocks_and_rates(a->g, b, a->s->device->rate);
}

static int go_solve(void *on)
{
    struct gpu *g = motion_of(on)->g;
    struct sheet *s = motion_of(on)->s;
    struct dynamics *d = &s->dynamics;
    struct pcg *p = &s->solver.pcg;
    p->block = d->block;
    p->packed = d->packed;
    p->b = d->b;
    p->dv = d->dv;
    p->tolerance = d->asked;
    if (!g->together)
        gpu_clock_start(g);
    int status = gpu_pcg_by_rates(g, p, s->device->rate);
    if (!g->together) /* else it is the time of many */
        s->solver.seconds += gpu_clock_stop(g);
    d->iterations += p->iterations;
    d->residual = (double)p->residual;
    if (status == DRAPE_OK && p->outcome != PCG_CONVERGED)
        d->outcome |= DRAPE_UNCONVERGED;
    return status;
}

static void go_copy(void *on, vec *to, const vec *from, size_t bytes)
{
    gpu_copy(motion_of(on)->g, to, from, bytes);
}

static void go_trace(void *on, const char *stage, const void *out, size_t bytes)
{
    const struct motion *a = motion_of(on);
    gpu_trace(a->g, a->s->dynamics.trace, stage, out, bytes);
}

static struct newton_stages stages_make(void)
{
    struct newton_stages run = {};
    run.wind = go_wind;
    run.springs = go_springs;
    run.blocks = go_blocks;
    run.predict = go_predict;
    run.rhs = go_rhs;
    run.update = go_update;
    run.imbalance = go_imbalance;
    run.dot = go_dot;
    run.solve = go_solve;
    run.copy = go_copy;
    run.trace = go_trace;
    return run;
}

static int go_implicit(struct gpu *g, struct sheet *s)
{
    struct newton_stages run = stages_make();
    struct motion on = {g, s};
    gpu_hand_over(g);
    int status = newton_move(&s->dynamics, &run, &on);
    gpu_hand_over(g);
    return status;
}

static void begin(struct sheet *s)
{
    struct dynamics *d = &s->dynamics;
    d->outcome = 0;
    d->iterations = 0;
    d->residual = 0;
    lay_out(s);
}

static int finish(struct gpu *g, struct sheet *s, int status)
{
    if (status != DRAPE_OK)
        return status;
    if (!gpu_motion_bounded(g, s))
        gpu_motion_copy(g, s, s->dynamics.x, s->dynamics.v);
    return gpu_status(g);
}

int gpu_motion(struct gpu *g, struct sheet *s)
{
    begin(s);
    return finish(g, s,
                  dynamics_implicit(s->dynamics.method)
                      ? go_implicit(g, s)
                      : gpu_motion_explicit(g, s));
}

/* The scratch of a part is lent between two parts. What one leaves to another,
 * and the wind, is not: gpu/world/sheet.cu. */
int gpu_motion_part(struct gpu *g, struct sheet *s, int part)
{
    struct newton_stages run = stages_make();
    struct motion on = {g, s};
    switch (part) {
    case MOTION_OPEN:
        begin(s);
        gpu_hand_over(g);
        return newton_open(&s->dynamics, &run, &on);
    case MOTION_PLACE:
        return newton_place(&s->dynamics, &run, &on);
    case MOTION_BALANCE:
        gpu_hand_over(g);
        return newton_balance(&s->dynamics, &run, &on);
    case MOTION_LINEARISE:
        return newton_linearise(&s->dynamics, &run, &on);
    case MOTION_END:
        return finish(g, s, DRAPE_OK);
    }
    return DRAPE_EARG;
}
