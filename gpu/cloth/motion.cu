/* SPDX-License-Identifier: Apache-2.0 */
/* One cloth's step without contact: each method as a sequence of stages.
 * spec/cloth/dynamics.md */
#include "gpu/cloth/motion.cuh"

static void wind(struct gpu *g, struct sheet *s, const vec *x, const vec *v,
                 vec *part)
{
    const struct cloth *c = &s->cloth;
    struct wind a = {};
    a.m = c->m;
    a.n = c->n;
    a.count = c->count;
    a.cell = c->cell;
    a.x = x;
    a.v = v;
    a.air = s->dynamics.air;
    a.drag = s->dynamics.drag;
    a.lift = s->dynamics.lift;
    a.part = part;
    a.force = part + 2 * c->count;
    gpu_wind(g, &a);
    motion_trace(g, s, "wind", a.force);
}

/* The wind's three streams are the last. */
struct springs gpu_motion_springs(struct gpu *g, struct sheet *s, const vec *x,
                                  const vec *v, const vec *damping)
{
    const struct cloth *c = &s->cloth;
    const struct dynamics *d = &s->dynamics;
    vec *part = motion_stream(s, (int)motion_vecs(d) - 3);
    if (d->windy)
        wind(g, s, x, v, part);
    struct springs f = {};
    f.m = c->m;
    f.n = c->n;
    f.count = c->count;
    f.laws = SPRINGS;
    f.law = s->device->law;
    f.springs = c->springs;
    f.triples = c->triples;
    f.triple = s->device->triple;
    f.n_beside = c->triples ? c->count : 0;
    f.beside = c->beside;
    f.mass = c->mass;
    f.x = x;
    f.n_v = damping && c->beta > 0 ? c->count : 0;
    f.v = damping;
    f.n_wind = d->windy ? c->count : 0;
    f.wind = d->windy ? part + 2 * c->count : NULL;
    f.gravity = d->gravity;
    f.force = motion_stream(s, 0);
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

/* What the stages of an implicit step share. spec/cloth/implicit.md */
struct about {
    int64_t past; /* count, or 0 */
    real tau;
    vec *star, *back, *q;
};

static void predict(struct gpu *g, struct sheet *s, const struct about *a)
{
    const struct dynamics *d = &s->dynamics;
    struct predict p = {};
    p.count = s->cloth.count;
    p.fixed = s->cloth.fixed;
    p.x = d->x;
    p.v = d->v;
    p.n_past = a->past;
    p.xp = d->xp;
    p.vp = d->vp;
    p.to = d->to;
    p.tau = a->tau;
    p.star = a->star;
    p.back = a->back;
    p.q = a->q;
    gpu_predict(g, &p);
    motion_trace(g, s, "predict", p.star);
}

static void blocks(struct gpu *g, struct sheet *s, const struct about *a)
{
    const struct cloth *c = &s->cloth;
    struct blocks b = {};
    b.count = c->count;
    b.m = c->m;
    b.laws = SPRINGS;
    b.law = s->device->law;
    b.springs = c->springs;
    b.triples = c->triples;
    b.triple = s->device->triple;
    b.n_beside = c->triples ? c->count : 0;
    b.beside = c->beside;
    b.x = s->dynamics.x;
    b.tau = a->tau;
    b.block = s->dynamics.block;
    b.n_thin = s->dynamics.thin ? SPRINGS * c->count : 0;
    b.thin = s->dynamics.thin;
    gpu_blocks_and_rates(g, &b, s->device->rate);
    gpu_trace(g, s->dynamics.trace, "blocks", b.block,
              (size_t)(SPRINGS * c->count) * sizeof *b.block);
}

static void rhs(struct gpu *g, struct sheet *s, const struct about *a)
{
    const struct cloth *c = &s->cloth;
    struct rhs r = {};
    r.count = c->count;
    r.m = c->m;
    r.n = c->n;
    r.fixed = c->fixed;
    r.springs = c->springs;
    r.n_blocks = SPRINGS * c->count;
    r.block = s->dynamics.block;
    r.force = motion_stream(s, 0);
    r.n_press = s->dynamics.press ? c->count : 0;
    r.press = s->dynamics.press;
    r.q = a->q;
    r.tau = a->tau;
    r.b = s->dynamics.b;
    gpu_rhs(g, &r);
    motion_trace(g, s, "rhs", r.b);
}

static int solve(struct gpu *g, struct sheet *s)
{
    struct dynamics *d = &s->dynamics;
    s->solver.pcg.block = d->block;
    s->solver.pcg.thin = d->thin;
    s->solver.pcg.b = d->b;
    s->solver.pcg.dv = d->dv;
    gpu_clock_start(g);
    int status =
        gpu_pcg_by_rates(g, &s->solver.pcg, rates{s->device->rate, d->x});
    s->solver.seconds = gpu_clock_stop(g);
    d->iterations += s->solver.pcg.iterations;
    d->residual = (double)s->solver.pcg.residual;
    if (status == DRAPE_OK && s->solver.pcg.outcome != PCG_CONVERGED)
        d->outcome |= DRAPE_UNCONVERGED;
    motion_trace(g, s, "pcg", d->dv);
    return status;
}

static void update(struct gpu *g, struct sheet *s, const struct about *a)
{
    const struct dynamics *d = &s->dynamics;
    struct update u = {};
    u.count = s->cloth.count;
    u.fixed = s->cloth.fixed;
    u.x = d->x;
    u.n_past = a->past;
    u.xp = d->xp;
    u.to = d->to;
    u.star = a->star;
    u.dv = d->dv;
    u.tau = a->tau;
    u.dt = (real)d->dt;
    u.x1 = d->x1;
    u.v1 = d->v1;
    gpu_update(g, &u);
    motion_trace(g, s, "update", u.v1);
}

static int go_implicit(struct gpu *g, struct sheet *s)
{
    struct dynamics *d = &s->dynamics;
    struct about a;
    a.past = d->method == DRAPE_CK && d->has_past ? s->cloth.count : 0;
    a.tau = (real)(a.past ? d->dt * 2 / 3 : d->dt);
    a.star = s->device->star;
    a.back = a.past ? motion_stream(s, 2) : NULL;
    a.q = a.past ? motion_stream(s, 3) : a.star;
    d->b = s->device->b;
    d->dv = motion_stream(s, 1);
    d->substeps = 1;
    gpu_hand_over(g);
    predict(g, s, &a);
    gpu_motion_force(g, s, d->x, d->v, a.back);
    blocks(g, s, &a);
    rhs(g, s, &a);
    int status = solve(g, s);
    if (status == DRAPE_OK)
        update(g, s, &a);
    gpu_hand_over(g);
    return status;
}

int gpu_motion(struct gpu *g, struct sheet *s)
{
    struct dynamics *d = &s->dynamics;
    d->outcome = 0;
    d->iterations = 0;
    d->residual = 0;
    int status = dynamics_implicit(d->method) ? go_implicit(g, s)
                                              : gpu_motion_explicit(g, s);
    if (status != DRAPE_OK)
        return status;
    if (!gpu_motion_bounded(g, s))
        gpu_motion_copy(g, s, d->x, d->v);
    return gpu_status(g);
}
