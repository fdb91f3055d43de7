/* SPDX-License-Identifier: Apache-2.0 */
/* Contact in a slice of a step on the device: ref/world/collide.c again.
 * spec/world/step.md §3, §7 */
#include "gpu/base/largest.cuh"
#include "gpu/world/collide.cuh"

/* The time is the host's, which waits where a part ends. */
void gpu_charge(struct gpu_world *w, drape_step_report *r, enum drape_part part,
                double *last, double within)
{
    gpu_wait(w->gpu);
    double t = clock_now();
    r->seconds[part] += t - *last - within;
    *last = t;
}

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

static void charge_contact(struct gpu_world *w, drape_step_report *r,
                           enum drape_part part, double *last)
{
    gpu_charge(w, r, part, last, w->broad_seconds + w->couple.seconds);
    r->seconds[DRAPE_PART_BROAD] += w->broad_seconds;
    r->seconds[DRAPE_PART_SOLVER] += w->couple.seconds;
    w->broad_seconds = w->couple.seconds = 0;
    slice_count(&r->work, &w->broad);
}

/* Thread i owns vertex i: the square of its way, m²; a block its largest. */
static __global__ void __launch_bounds__(GPU_BLOCK)
    way_kernel(int64_t n, const vec *x0, const vec *x1, int64_t *most)
{
    int64_t i = (int64_t)blockIdx.x * GPU_BLOCK + threadIdx.x;
    vec d = i < n ? sub(x1[i], x0[i]) : make(0, 0, 0);
    block_largest(most, dot(d, d));
}

real gpu_collide_furthest(struct gpu_world *w, int64_t n)
{
    int64_t *most = gpu_words(w->gpu);
    LAUNCH_BLOCKS(w->gpu, largest_blocks(n), GPU_BLOCK, way_kernel, n, w->x0,
                  w->x1, most);
    return largest_of(gpu_read_words(w->gpu, 1));
}

static int find_near(struct gpu_world *w, const vec *to, real r)
{
    double start = clock_now();
    bool apart = false;
    int status = DRAPE_OK;
    if (w->host->near == NEAR_NONE)
        status = gpu_broad_ask(w->gpu, &w->broad, w->x0, to, r, &apart);
    if (status == DRAPE_OK && !apart)
        status = gpu_broad_query(w->gpu, &w->broad, w->x0, to, r, NULL);
    w->broad_seconds += clock_now() - start;
    return status;
}

int gpu_collide_far(struct gpu_world *w, drape_step_report *r, double *last,
                    bool *again)
{
    struct world *h = w->host;
    real way = gpu_collide_furthest(w, h->nv);
    *again = slice_far(h, 4 * way);
    if (!*again)
        return gpu_status(w->gpu);
    int status = find_near(w, w->x1, 0);
    struct travel t = {h->nv,
                       w->broad.n,
                       (const int32_t *)w->broad.pair.data,
                       (const uint8_t *)w->broad.kind.data,
                       w->x0,
                       w->x1,
                       0};
    if (status == DRAPE_OK && t.n) {
        status = gpu_travel(w->gpu, &t);
        if (h->tracing)
            trace_stage(h->tracing, "travel", &t.most, sizeof t.most);
    }
    *again = slice_far(h, t.most);
    if (*again)
        slice_cut(h);
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
    r->work.near = c->near;
    r->work.later = c->later;
    r->work.narrow = c->narrow;
}

static int start(struct gpu_world *w)
{
    struct response *c = &w->response;
    c->x0 = w->x0;
    c->x1 = w->x1;
    c->v = w->v1;
    c->dt = (real)w->host->dt;
    c->brief = slice_brief(w->host);
    c->max_rounds = slice_rounds(w->host);
    int status = gpu_response_start(w->gpu, c);
    if (w->host->plan.implicit)
        gpu_couple_start(w);
    return status;
}

static int repel(struct gpu_world *w)
{
    int status = start(w);
    if (status == DRAPE_OK)
        status = find_near(w, w->x0, w->host->reach);
    struct pairs near = {w->broad.n, (const int32_t *)w->broad.pair.data,
                         (const uint8_t *)w->broad.kind.data};
    if (status == DRAPE_OK)
        status = gpu_response_repel(w->gpu, &w->response, &near);
    if (status == DRAPE_OK && w->couple.rough && w->couple.solves == 0)
        status = gpu_couple_solve(w, 0, NULL);
    return status;
}

static int look(struct gpu_world *w, bool *alone)
{
    response_reset(&w->response);
    *alone = false;
    if (w->host->near != NEAR_NONE)
        return DRAPE_OK;
    int status = find_near(w, w->x1, w->host->reach);
    *alone = w->broad.n == 0;
    return status;
}

int gpu_collide(struct gpu_world *w, drape_step_report *r, double *last)
{
    struct response *c = &w->response;
    bool alone;
    int status = look(w, &alone);
    if (status == DRAPE_OK && !alone)
        status = repel(w);
    charge_contact(w, r, DRAPE_PART_PROXIMITY, last);
    w->host->met = !alone;
    if (status != DRAPE_OK || alone)
        return status;
    status = gpu_response_penetrate(w->gpu, c);
    charge_contact(w, r, DRAPE_PART_PENETRATION, last);
    count_contacts(c, r);
    r->iterations += w->couple.iterations;
    r->work.solves += w->couple.solves;
    if (w->couple.rough || w->couple.residual > r->residual)
        r->residual = w->couple.residual;
    r->outcome |= w->couple.outcome;
    return status;
}
