/* SPDX-License-Identifier: Apache-2.0 */
/* The pipeline of one step on the device: ref/step.c again, with streams that
 * stay there. spec/00_step.md, spec/50_gpu.md §6 */
#include "gpu/real.cuh"

enum { REST_STEPS = 30 };
static const double REST_PART = 1e-3; /* of the thickness, a step */

/* ---- §1 Time: of the host, which waits where a part ends ---- */

static void charge(struct gpu_world *w, drape_step_report *r,
                   enum drape_part part, double *last, double within)
{
    gpu_wait(w->gpu);
    double t = clock_now();
    r->seconds[part] += t - *last - within;
    *last = t;
}

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
    d->has_past = h->has_past;
    d->to = w->to + s->first;
    d->x1 = w->x1 + s->first;
    d->v1 = w->v1 + s->first;
    d->reference = h->watch[k][0];
    d->surplus = h->watch[k][1];
    d->iterations = 0;
    d->residual = 0;
    d->outcome = 0;
    int status = gpu_motion(w->gpu, s);
    if (status != DRAPE_OK)
        return status;
    r->outcome |= d->outcome;
    r->iterations += d->iterations;
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

/* ---- §4 Contact ---- */

int gpu_step_broad(void *user, const uint8_t *touched, struct pairs *out)
{
    struct gpu_world *w = (struct gpu_world *)user;
    double start = clock_now();
    int status = gpu_broad_query(w->gpu, &w->broad, w->x0, w->x1, 0, touched);
    w->broad_seconds += clock_now() - start;
    out->n = w->broad.n;
    out->pair = (const int32_t *)w->broad.pair.data;
    out->kind = (const uint8_t *)w->broad.kind.data;
    return status;
}

static int repel(struct gpu_world *w)
{
    double start = clock_now();
    int status =
        gpu_broad_query(w->gpu, &w->broad, w->x0, w->x0, w->host->reach, NULL);
    w->broad_seconds += clock_now() - start;
    if (status != DRAPE_OK)
        return status;
    struct pairs near = {w->broad.n, (const int32_t *)w->broad.pair.data,
                         (const uint8_t *)w->broad.kind.data};
    return gpu_response_repel(w->gpu, &w->response, &near);
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

static void charge_contact(struct gpu_world *w, drape_step_report *r,
                           enum drape_part part, double *last)
{
    charge(w, r, part, last, w->broad_seconds + w->couple.seconds);
    r->seconds[DRAPE_PART_BROAD] += w->broad_seconds;
    r->seconds[DRAPE_PART_SOLVER] += w->couple.seconds;
    w->broad_seconds = w->couple.seconds = 0;
}

static int collide(struct gpu_world *w, drape_step_report *r, double *last)
{
    struct response *c = &w->response;
    c->x0 = w->x0;
    c->x1 = w->x1;
    c->v = w->v1;
    int status = gpu_response_start(w->gpu, c);
    if (w->host->plan.implicit)
        gpu_couple_start(w);
    if (status == DRAPE_OK)
        status = repel(w);
    charge_contact(w, r, DRAPE_PART_PROXIMITY, last);
    if (status == DRAPE_OK)
        status = gpu_response_penetrate(w->gpu, c);
    charge_contact(w, r, DRAPE_PART_PENETRATION, last);
    count_contacts(c, r);
    r->iterations += w->couple.iterations;
    return status;
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
                        .dt = (real)h->def.dt,
                        .xp = w->past_x,
                        .vp = w->past_v};
    gpu_history(w->gpu, &s);
    gpu_trace(w->gpu, h->tracing, "history", w->past_v,
              (size_t)h->nc * sizeof *w->past_v);
    h->has_past = true;
}

/* Thread i owns particle i: notes one that went further than `most`. */
static __global__ void __launch_bounds__(GPU_BLOCK)
    rests_kernel(int64_t n, const vec *x0, const vec *x1, real most,
                 int64_t *moved)
{
    ITEM(i, n);
    vec d = sub(x1[i], x0[i]);
    if (!(dot(d, d) <= most * most))
        *moved = 1; /* whoever writes, writes the same */
}

static bool rests(struct gpu_world *w)
{
    real most = (real)REST_PART * w->host->reach;
    int64_t *moved = gpu_words(w->gpu);
    LAUNCH(w->gpu, w->host->nc, rests_kernel, w->host->nc, w->x0, w->x1, most,
           moved);
    return gpu_read_words(w->gpu, 1)[0] == 0;
}

static void commit(struct gpu_world *w)
{
    struct world *h = w->host;
    if (h->plan.history)
        remember(w);
    h->resting = h->def.sleep && rests(w) ? h->resting + 1 : 0;
    h->asleep = h->resting >= REST_STEPS;
    for (int k = 0; k < h->def.n_cloths; k++) {
        h->watch[k][0] = w->sheet[k].dynamics.reference;
        h->watch[k][1] = w->sheet[k].dynamics.surplus;
    }
    vec *x = w->x0, *v = w->v0;
    w->x0 = w->x1;
    w->v0 = w->v1;
    w->x1 = x;
    w->v1 = v;
    h->step++;
    h->time = (double)h->step * h->def.dt;
}

static void weigh(struct gpu_world *w, drape_step_report *r)
{
    for (int k = 0; k < w->host->def.n_cloths; k++) {
        struct gpu_sheet *s = &w->sheet[k];
        double value[3];
        gpu_motion_energy(w->gpu, s, w->x0 + s->first, w->v0 + s->first, value);
        r->kinetic += value[0];
        r->elastic += value[1];
        r->potential += value[2];
    }
    r->step = w->host->step;
    r->time = w->host->time;
}

/* ---- The pipeline ---- */

int gpu_step(struct world *h, drape_step_report *r)
{
    struct gpu_world *w = h->device;
    double last = clock_now(), end = (double)(h->step + 1) * h->def.dt;
    memset(r, 0, sizeof *r);
    gpu_begin(w->gpu);
    h->trace.step = h->step;
    h->trace.last = last;
    int status = gpu_lead(w, end, w->x1); /* 01 kinematics */
    gpu_trace(w->gpu, h->tracing, "kinematics", w->x1 + h->nc,
              (size_t)(h->nv - h->nc) * sizeof *w->x1);
    if (status != DRAPE_OK)
        return status;
    if (h->asleep && !gpu_lead_moves(w)) {
        r->outcome = DRAPE_ASLEEP;
        h->step++;
        h->time = end;
        weigh(w, r);
        return gpu_status(w->gpu);
    }
    status = move(w, r); /* 03 wind … 09 dynamics, 10 sum … 15 pcg */
    for (int k = 0; k < h->def.n_cloths; k++)
        r->seconds[DRAPE_PART_SOLVER] += w->sheet[k].solver_seconds;
    charge(w, r, DRAPE_PART_INTEGRATION, &last, r->seconds[DRAPE_PART_SOLVER]);
    if (status != DRAPE_OK)
        return status;
    if (!(r->outcome & DRAPE_DIVERGED)) {
        if (h->plan.collides)
            status = collide(w, r, &last); /* 20 refit … 37 response */
        if (status != DRAPE_OK)
            return status;
        commit(w);
    }
    weigh(w, r);
    return gpu_status(w->gpu);
}
