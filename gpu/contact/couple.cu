/* SPDX-License-Identifier: Apache-2.0 */
/* Contacts within the implicit solve of every cloth, on the device.
 * spec/contact/penalty.md §4 */
#include "gpu/base/real.cuh"
#include "gpu/contact/incidence.cuh"
#include "gpu/contact/response.cuh"
#include "gpu/run/tape.cuh"

enum { TURNS = 2 }; /* of the first contacts of a slice; later ones: 1 */

/* One cloth's part of the streams; hold, b and dv are pcg's too. g, b and dv
 * are the motion's star, b and dv, as that is done by then. */
struct part {
    int64_t count;
    const uint8_t *fixed;
    const sym *hold;
    const vec *r, *dv; /* pcg's: residual and result */
    vec *g, *b;        /* b: penalty's force at first */
    const vec *x0;
    vec *u, *v, *x1;
    uint8_t *touched;
    real span, dt;
};

int gpu_couple_make(struct gpu_world *w)
{
    struct penalty *p = &w->couple.penalty;
    int64_t nv = w->host->nv;
    p->nv = nv;
    p->nv1 = nv + 1;
    p->w = w->w;
    p->u = w->response.u;
    p->stiffness = w->response.stiffness;
    p->start = w->response.start;
    struct gpu *g = w->gpu;
    p->force = w->b;
    p->g = w->couple.g = w->star;
    p->hold = (sym *)gpu_take(g, ARENA_RESPONSE, nv, sizeof(sym));
    p->guess = (vec *)gpu_borrow(g, ARENA_RESPONSE, nv, sizeof(vec));
    w->couple.press = p->guess; /* of the last contacts: no solve is after */
    p->brake = (real *)gpu_borrow(g, ARENA_RESPONSE, nv, sizeof(real));
    return gpu_status(g);
}

/* Thread i owns particle i: g begins with what presses already. */
static __global__ void __launch_bounds__(GPU_BLOCK)
    couple_begin_kernel(vec *g, const vec *press, real dt, int64_t n)
{
    ITEM(i, n);
    g[i] = scale(dt, press[i]);
}

void gpu_couple_start(struct gpu_world *w)
{
    const struct world *h = w->host;
    struct penalty *p = &w->couple.penalty;
    bool past = h->plan.history && state_has_past(h);
    p->dt = w->response.dt;
    p->slip = real_min(R(1e-3), R(0.01) * h->reach / p->dt);
    p->tau = (real)(past ? h->dt * 2 / 3 : h->dt);
    w->couple.iterations = w->couple.solves = w->couple.outcome = 0;
    w->couple.residual = 0;
    w->couple.seconds = 0;
    if (state_warm(h))
        LAUNCH(w->gpu, h->nc, couple_begin_kernel, w->couple.g, w->press, p->dt,
               h->nc);
    else
        gpu_clear(w->gpu, w->couple.g, (size_t)h->nc * sizeof *w->couple.g);
}

/* The lists are warm's, too; the rest is penalty's alone, in the pools of stage
 * contacts, which comes later. */
static int make_room(struct gpu_world *w, int64_t n)
{
    struct couple *c = &w->couple;
    struct penalty *p = &c->penalty;
    struct response *s = &w->response;
    struct gpu *g = w->gpu;
    struct room room[] = {{&s->vertex, 4 * n, sizeof(int32_t)},
                          {&s->lack, n, sizeof(real)},
                          {&s->push, 2 * n, sizeof(vec)}};
    int status = gpu_response_grow(g, 3, room);
    p->vertex = (int32_t *)s->vertex.data;
    p->share = (real *)s->lack.data;
    p->gave = (real *)s->push.data;
    p->most = p->gave + n;
    p->more = p->most + n;
    if (status != DRAPE_OK || n <= c->cap)
        return status;
    gpu_give(g, p->item);
    int64_t cap = n + n / 4 + 64;
    p->item = (int32_t *)gpu_take(g, ARENA_RESPONSE, 4 * cap, sizeof(int32_t));
    c->cap = p->item ? cap : 0;
    return gpu_status(g);
}

/* Thread i owns particle i: b -= g, but 0 where fixed. */
static __global__ void __launch_bounds__(GPU_BLOCK)
    couple_rhs_kernel(struct part s)
{
    ITEM(i, s.count);
    s.b[i] = s.fixed[i] ? make(0, 0, 0) : sub(s.b[i], s.g[i]);
}

/* Thread i owns particle i: g gains A dv, whatever pcg left over; u, v, x1
 * move with dv. */
static __global__ void __launch_bounds__(GPU_BLOCK)
    couple_move_kernel(struct part s)
{
    ITEM(i, s.count);
    if (s.fixed[i])
        return;
    vec dv = s.dv[i];
    vec done = sub(sub(s.b[i], s.r[i]), apply(s.hold[i], dv));
    vec u = axpy(s.u[i], s.span, dv);
    s.g[i] = add(s.g[i], done);
    s.u[i] = u;
    s.v[i] = add(s.v[i], dv);
    s.x1[i] = axpy(s.x0[i], s.dt, u);
    s.touched[i] = 1;
}

static struct part part_of(struct gpu_world *w, const struct gpu_sheet *s)
{
    const struct couple *c = &w->couple;
    int64_t at = s->first;
    struct part p = {s->cloth.count,
                     s->cloth.fixed,
                     c->penalty.hold + at,
                     s->pcg.r,
                     s->dynamics.dv,
                     c->g + at,
                     s->b,
                     w->x0 + at,
                     w->response.u + at,
                     w->v1 + at,
                     w->x1 + at,
                     w->response.touched + at,
                     c->penalty.tau / c->penalty.dt,
                     w->response.dt};
    return p;
}

/* One cloth: (A + hold) dv = force - g; what moves is moved. */
static int solve_sheet(struct gpu_world *w, struct gpu_sheet *s)
{
    struct part part = part_of(w, s);
    struct pcg *p = &s->pcg;
    LAUNCH(w->gpu, part.count, couple_rhs_kernel, part);
    p->block = s->dynamics.block;
    p->thin = s->dynamics.thin;
    p->b = part.b;
    p->dv = s->dynamics.dv;
    p->n_extra = part.count;
    p->extra = part.hold;
    p->energy = 1;
    p->tolerance = (real)w->host->def.tolerance;
    gpu_hand_over(w->gpu);
    int status = gpu_pcg_by_rates(w->gpu, p, rates{s->rate, s->dynamics.x});
    gpu_trace(w->gpu, w->host->tracing, "pcg", p->dv,
              (size_t)part.count * sizeof *p->dv);
    p->n_extra = p->energy = 0;
    w->couple.iterations += p->iterations;
    if (p->outcome != PCG_CONVERGED)
        w->couple.outcome |= DRAPE_UNCONVERGED;
    if ((double)p->residual > w->couple.residual)
        w->couple.residual = (double)p->residual;
    w->couple.solves++;
    /* After a breakdown the exact rounds go on without. */
    if (status == DRAPE_OK && p->outcome != PCG_BREAKDOWN)
        LAUNCH(w->gpu, part.count, couple_move_kernel, part);
    gpu_hand_over(w->gpu);
    return status == DRAPE_OK ? gpu_status(w->gpu) : status;
}

/* Thread i owns particle i: what the solve of the free motion left over is the
 * first turn's to do. */
static __global__ void __launch_bounds__(GPU_BLOCK)
    couple_carry_kernel(struct part s)
{
    ITEM(i, s.count);
    s.g[i] = sub(s.g[i], s.r[i]);
}

static void carry(struct gpu_world *w)
{
    for (int k = 0; k < w->host->def.n_cloths; k++) {
        struct part part = part_of(w, &w->sheet[k]);
        LAUNCH(w->gpu, part.count, couple_carry_kernel, part);
    }
}

/* What these contacts press with in the next slice. warm.md */
static int keep_warm(struct gpu_world *w)
{
    struct couple *c = &w->couple;
    struct penalty *p = &c->penalty;
    struct warm s = {};
    s.nv = p->nv;
    s.n = p->n;
    s.w = p->w;
    s.g = c->g;
    s.v = w->v0;
    s.contact = p->contact;
    s.before = w->press;
    s.part = COUPLE_KEPT / p->dt;
    s.again = COUPLE_GROWTH / COUPLE_KEPT * p->dt;
    s.speed = COUPLE_GUST * w->host->reach / p->dt;
    s.nv1 = p->nv1;
    s.n4 = p->n4;
    s.start = p->start;
    s.item = p->item;
    s.all = p->brake;
    s.press = c->press;
    return gpu_warm(w->gpu, &s);
}

int gpu_couple_solve(void *user, int64_t n, struct contact *contact)
{
    struct gpu_world *w = (struct gpu_world *)user;
    struct penalty *p = &w->couple.penalty;
    double start = clock_now();
    gpu_once(w->gpu); /* it adds to x1 and v1 */
    struct amount some = gpu_amount(w->gpu, n);
    int status = make_room(w, some.most);
    p->n = n;
    p->n4 = 4 * n;
    p->contact = contact;
    int turns = n > 0 && w->couple.solves == 0 ? TURNS : 1;
    for (int k = 0; k < turns && status == DRAPE_OK; k++) {
        p->first = w->couple.solves == 0;
        status = gpu_penalty_queue(w->gpu, p, some, gpu_late_words(w->gpu));
        gpu_trace(w->gpu, w->host->tracing, "penalty", p->force,
                  (size_t)p->nv * sizeof *p->force);
        if (w->couple.rough && w->couple.solves == 0)
            carry(w);
        w->couple.residual = 0;
        for (int i = 0; i < w->host->def.n_cloths && status == DRAPE_OK; i++)
            status = solve_sheet(w, &w->sheet[i]);
        if (status == DRAPE_OK && gpu_late_seen(w->gpu)[INCIDENCE_BAD])
            status = DRAPE_EARG;
    }
    if (status == DRAPE_OK && n > 0 && w->host->plan.warm) {
        status = keep_warm(w);
        gpu_trace(w->gpu, w->host->tracing, "warm", w->couple.press,
                  (size_t)w->host->nc * sizeof *w->couple.press);
    }
    w->couple.seconds += clock_now() - start;
    return status;
}
