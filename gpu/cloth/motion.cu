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

/* The cloth of a motion on the device: gpu/world/sheet.cu. */
static struct sheet *sheet_of(const struct dynamics *d)
{
    return (struct sheet *)d->solver;
}

int gpu_motion_blocks(struct gpu *g, const struct dynamics *d, struct blocks *b)
{
    return gpu_blocks_and_rates(g, b, sheet_of(d)->device->rate);
}

int gpu_motion_solve(struct gpu *g, struct dynamics *d)
{
    struct sheet *s = sheet_of(d);
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

static int go_implicit(struct gpu *g, struct sheet *s)
{
    gpu_hand_over(g);
    int status = newton_move(&s->dynamics, &backend_gpu, g);
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
    switch (part) {
    case MOTION_OPEN:
        begin(s);
        gpu_hand_over(g);
        return newton_open(&s->dynamics, &backend_gpu, g);
    case MOTION_PLACE:
        return newton_place(&s->dynamics, &backend_gpu, g);
    case MOTION_BALANCE:
        gpu_hand_over(g);
        return newton_balance(&s->dynamics, &backend_gpu, g);
    case MOTION_LINEARISE:
        return newton_linearise(&s->dynamics, &backend_gpu, g);
    case MOTION_END:
        return finish(g, s, DRAPE_OK);
    }
    return DRAPE_EARG;
}
