/* SPDX-License-Identifier: Apache-2.0 */
/* A world on the device: made by ref/world/world.c, then copied there stream by
 * stream. spec/gpu.md §6 */
#include <stdio.h>

#include "gpu/cloth/motion.cuh"
#include "gpu/run/blas.h"

/* A stream on the device with what the host's holds; NULL: zero. */
static void *give(struct gpu_world *w, enum arena_part part, const void *host,
                  int64_t n, size_t size)
{
    void *p = gpu_take(w->gpu, part, n, size);
    if (p && host)
        gpu_up(w->gpu, p, host, (size_t)n * size);
    return p;
}

/* GIVE(pointer, part, host, n): with the size of what pointer points to. */
#define GIVE(p, part, host, n)                                                 \
    (p) = (decltype(p))give(w, part, host, n, sizeof *(p))

static void give_state(struct gpu_world *w)
{
    const struct world *h = w->host;
    GIVE(w->x0, ARENA_STATE, h->x0, h->nv);
    GIVE(w->v0, ARENA_STATE, h->v0, h->nv);
    GIVE(w->x1, ARENA_STATE, h->x0, h->nv);
    GIVE(w->v1, ARENA_STATE, h->v0, h->nv);
    GIVE(w->w, ARENA_STATE, h->w, h->nv);
    GIVE(w->body, ARENA_STATE, h->body, h->nv);
    GIVE(w->surface, ARENA_STATE, h->surface,
         h->def.n_cloths + h->def.n_obstacles);
    GIVE(w->pose, ARENA_OTHER, h->pose, h->def.n_motions);
    if (h->plan.history) {
        GIVE(w->past_x, ARENA_STATE, h->past_x, h->nc);
        GIVE(w->past_v, ARENA_STATE, h->past_v, h->nc);
    }
    if (h->plan.warm)
        GIVE(w->press, ARENA_STATE, h->press, h->nc);
    if (h->plan.history && h->plan.collides) {
        GIVE(w->free_x, ARENA_STATE, NULL, h->nc);
        GIVE(w->free_v, ARENA_STATE, NULL, h->nc);
    }
}

/* Where pins end: an implicit method reads no more. */
static bool reads_to(const struct world *h)
{
    bool reads = !h->plan.implicit;
    for (int k = 0; k < h->def.n_cloths; k++)
        reads |= h->sheet[k].cloth.n_pinned > 0;
    return reads;
}

static void give_motion(struct gpu_world *w)
{
    const struct world *h = w->host;
    if (reads_to(h))
        GIVE(w->to, ARENA_STATE, h->to, h->nc);
    if (!h->plan.implicit)
        return;
    GIVE(w->star, ARENA_SOLVER, NULL, h->nc);
    GIVE(w->b, ARENA_SOLVER, NULL, h->plan.collides ? h->nv : h->nc);
}

static void give_place(struct gpu_world *w, enum arena_part part,
                       const struct kinematics *host, struct kinematics *k)
{
    *k = *host;
    k->rest = k->next = NULL;
    double *rest = NULL;
    int32_t *motion = NULL;
    GIVE(rest, part, host->rest, 3 * host->n);
    GIVE(motion, part, host->motion, host->n);
    k->rest = rest;
    k->motion = motion;
    k->pose = w->pose;
}

/* Streams one behind the other in one block; without it, its size. */
struct row {
    char *block;
    size_t at;
};

static void *next_in(struct row *row, int64_t n, size_t size)
{
    size_t align = 256, at = row->at; /* as cudaMalloc's */
    row->at = (at + (size_t)n * size + align - 1) / align * align;
    return row->block ? row->block + at : NULL;
}

#define NEXT(p, n) (p) = (decltype(p))next_in(&row, n, sizeof *(p))

/* A cloth's solver in one block, sizes or streams: r, which a slice's first
 * contacts read, and all that is lent. Of multigrid's finest grid pool and room
 * lack what p and q lend it; these lie before the force, which rhs alone reads.
 */
static struct row lay_out(struct gpu_sheet *s, int64_t vecs, char *block)
{
    struct row row = {block, 0};
    struct pcg *p = &s->pcg;
    int64_t lent = p->grid.n_pool ? p->count : 0;
    NEXT(p->r, p->count);
    NEXT(p->cdf, p->n_cdf);
    NEXT(p->diagonal, p->n_cdf ? p->count : 0);
    NEXT(p->factor, p->count);
    NEXT(p->low, p->count);
    NEXT(p->s, p->count);
    NEXT(p->grid.pool, p->grid.n_pool - lent);
    NEXT(p->grid.room, p->grid.n_room - lent);
    NEXT(p->grid.live, p->grid.n_live);
    NEXT(p->p, (2 + vecs) * p->count);
    return row;
}

static void give_solver(struct gpu_world *w, struct gpu_sheet *s, int64_t vecs)
{
    struct pcg *p = &s->pcg;
    char *block = NULL;
    GIVE(p->chunk, ARENA_SOLVER, NULL, p->n_chunks);
    GIVE(p->grid.dense, ARENA_SOLVER, NULL, p->grid.n_dense);
    GIVE(block, ARENA_SOLVER, NULL, (int64_t)lay_out(s, vecs, NULL).at);
    if (!block)
        return;
    lay_out(s, vecs, block);
    p->q = p->p + p->count;
    s->dynamics.work = p->q + p->count;
    vec *from = p->r + p->count, *to = s->dynamics.work + vecs * p->count;
    gpu_lend(w->gpu, from, (size_t)((char *)to - (char *)from));
}

static void give_sheet(struct gpu_world *w, int k)
{
    struct sheet *h = &w->host->sheet[k];
    struct gpu_sheet *s = &w->sheet[k];
    struct cloth *c = &s->cloth;
    struct dynamics *d = &s->dynamics;
    s->first = h->first;
    *c = h->cloth;
    c->tri = NULL;
    GIVE(c->cell, ARENA_CLOTH, h->cloth.cell, c->count);
    GIVE(c->springs, ARENA_CLOTH, h->cloth.springs, c->count);
    GIVE(c->fixed, ARENA_CLOTH, h->cloth.fixed, c->count);
    GIVE(c->mass, ARENA_CLOTH, h->cloth.mass, c->count);
    GIVE(s->law, ARENA_CLOTH, c->law, SPRINGS);
    GIVE(s->pinned, ARENA_CLOTH, h->pinned, h->pins.n);
    give_place(w, ARENA_CLOTH, &h->pins, &s->pins);
    GIVE(s->pins.x, ARENA_CLOTH, h->pins.x, h->pins.n);
    *d = h->dynamics;
    d->cloth = c;
    int64_t vecs = motion_vecs(d);
    GIVE(d->chunk, ARENA_SOLVER, NULL, 3 * sum_chunks(c->count));
    if (!w->host->plan.implicit) {
        GIVE(d->work, ARENA_SOLVER, NULL, (vecs + motion_spares(d)) * c->count);
        return;
    }
    s->star = w->star + s->first;
    s->b = w->b + s->first;
    GIVE(d->block, ARENA_SOLVER, NULL, SPRINGS * c->count);
    s->pcg = h->solver.pcg;
    if (s->pcg.n_thin)
        GIVE(d->thin, ARENA_SOLVER, NULL, s->pcg.n_thin);
    if (gpu_rates_help(w->gpu, &s->pcg))
        GIVE(s->rate, ARENA_SOLVER, NULL, SPRINGS * RATES_PITCH(c->count));
    s->pcg.mass = c->mass;
    s->pcg.fixed = c->fixed;
    give_solver(w, s, vecs);
}

static void give_prop(struct gpu_world *w, int k)
{
    const struct prop *h = &w->host->prop[k];
    struct gpu_prop *p = &w->prop[k];
    give_place(w, ARENA_OBSTACLE, &h->place, &p->place);
    if (h->frames)
        GIVE(p->frame, ARENA_OBSTACLE, h->frame, 3 * h->place.n * h->frames);
}

static int give_response(struct gpu_world *w)
{
    struct response *c = &w->response;
    const struct world *h = w->host;
    *c = h->response;
    c->w = w->w;
    c->skin.of = w->body;
    c->skin.surface = w->surface;
    c->user = w;
    c->broad = gpu_step_broad;
    c->grow = NULL;
    GIVE(c->u, ARENA_RESPONSE, NULL, h->nv);
    GIVE(c->touched, ARENA_RESPONSE, NULL, h->nv);
    GIVE(c->rolled, ARENA_RESPONSE, NULL, h->nv);
    GIVE(c->start, ARENA_RESPONSE, NULL, h->nv + 1);
    if (!h->plan.implicit)
        return gpu_status(w->gpu);
    c->solve = gpu_couple_solve;
    return gpu_couple_make(w);
}

static int open_device(struct world *h, drape_error *error)
{
    int status;
    struct gpu_world *w =
        (struct gpu_world *)arena_take(h->arena, ARENA_OTHER, 1, sizeof *w);
    if (!w)
        return DRAPE_ENOMEM;
    h->device = w;
    w->host = h;
    w->gpu = gpu_open(&h->def, &status);
    if (status == DRAPE_EDEVICE && error)
        snprintf(error->text, sizeof error->text,
                 "backend gpu: there is no device here that can be used");
    if (!w->gpu)
        return status;
    h->held = gpu_held(w->gpu);
    if (h->def.solver == DRAPE_CUBLAS)
        status = blas_open(w->gpu);
    if (status == DRAPE_EDEVICE && error)
        snprintf(error->text, sizeof error->text,
                 "solver cublas: libcublas cannot be found or used");
    return status;
}

static int make(const drape_def *def, struct arena *arena, struct world **world,
                drape_error *error)
{
    int status = world_make(def, arena, world, error);
    struct world *h = *world;
    if (status == DRAPE_OK)
        status = open_device(h, error);
    if (status != DRAPE_OK)
        return status;
    struct gpu_world *w = h->device;
    w->sheet = (struct gpu_sheet *)arena_take(arena, ARENA_OTHER, def->n_cloths,
                                              sizeof *w->sheet);
    w->prop = (struct gpu_prop *)arena_take(arena, ARENA_OTHER,
                                            def->n_obstacles, sizeof *w->prop);
    if (arena->failed)
        return DRAPE_ENOMEM;
    give_state(w);
    give_motion(w);
    for (int k = 0; k < def->n_cloths; k++)
        give_sheet(w, k);
    for (int k = 0; k < def->n_obstacles; k++)
        give_prop(w, k);
    status = gpu_status(w->gpu);
    if (h->tracing) /* so that a step that is done has room for its trace */
        gpu_aside(w->gpu, (size_t)h->nv * sizeof(vec));
    if (status == DRAPE_OK && h->plan.collides)
        status = gpu_broad_make(w->gpu, &h->broad, &w->broad);
    if (status == DRAPE_OK && h->plan.collides)
        status = give_response(w);
    gpu_wait(w->gpu);
    return status == DRAPE_OK ? gpu_status(w->gpu) : status;
}

static void count(const struct world *h, drape_memory *m)
{
    gpu_count(h->device->gpu, m);
}

static void end(struct world *h)
{
    if (h->device)
        gpu_close(h->device->gpu);
}

/* ---- The state, from and to the host's streams ---- */

static int fetch(const struct world *h)
{
    struct gpu_world *w = h->device;
    size_t bytes = (size_t)h->nv * sizeof *w->x0;
    size_t past = w->past_x ? (size_t)h->nc * sizeof *w->past_x : 0;
    size_t press = w->press ? (size_t)h->nc * sizeof *w->press : 0;
    gpu_begin(w->gpu);
    gpu_down(w->gpu, h->x0, w->x0, bytes);
    gpu_down(w->gpu, h->v0, w->v0, bytes);
    gpu_down(w->gpu, h->past_x, w->past_x, past);
    gpu_down(w->gpu, h->past_v, w->past_v, past);
    gpu_down(w->gpu, h->press, w->press, press);
    return gpu_status(w->gpu);
}

static int read(const struct world *h, double (*x)[3], double (*v)[3])
{
    int status = fetch(h);
    return status == DRAPE_OK ? world_read(h, x, v) : status;
}

static int borrow(struct world *h, drape_view *view)
{
    struct gpu_world *w = h->device;
    gpu_begin(w->gpu);
    if (!w->tri && h->plan.collides)
        w->tri = w->broad.tree.tri;
    else if (!w->tri)
        GIVE(w->tri, ARENA_STATE, h->tri, h->nt);
    int status = gpu_status(w->gpu);
    if (status != DRAPE_OK)
        return status;
    view->x = w->x0;
    view->v = w->v0;
    view->tri = w->tri;
    view->device = gpu_device(w->gpu);
    view->stream = gpu_stream(w->gpu);
    return DRAPE_OK;
}

static const char *device(const struct world *h)
{
    return gpu_name(h->device->gpu);
}

static int save(const struct world *h, drape_write *write, void *user)
{
    int status = fetch(h);
    return status == DRAPE_OK ? checkpoint_save(h, write, user) : status;
}

static void give_air(struct world *h)
{
    for (int k = 0; k < h->def.n_cloths; k++) {
        struct dynamics *d = &h->device->sheet[k].dynamics;
        d->air = h->sheet[k].dynamics.air;
        d->drag = h->sheet[k].dynamics.drag;
        d->lift = h->sheet[k].dynamics.lift;
    }
}

static int load(struct world *h, drape_read_bytes *read, void *user)
{
    struct gpu_world *w = h->device;
    int status = checkpoint_load(h, read, user);
    if (status != DRAPE_OK)
        return status;
    gpu_begin(w->gpu);
    size_t bytes = (size_t)h->nv * sizeof *w->x0;
    size_t past = w->past_x ? (size_t)h->nc * sizeof *w->past_x : 0;
    size_t press = w->press ? (size_t)h->nc * sizeof *w->press : 0;
    gpu_up(w->gpu, w->x0, h->x0, bytes);
    gpu_up(w->gpu, w->v0, h->v0, bytes);
    gpu_up(w->gpu, w->x1, h->x0, bytes); /* what never moves is not led */
    gpu_up(w->gpu, w->past_x, h->past_x, past);
    gpu_up(w->gpu, w->past_v, h->past_v, past);
    gpu_up(w->gpu, w->press, h->press, press);
    gpu_wait(w->gpu);
    give_air(h);
    return gpu_status(w->gpu);
}

static int set_wind(struct world *h, const drape_wind *wind)
{
    int status = world_set_wind(h, wind);
    give_air(h);
    return status;
}

const struct world_ops world_ops_gpu = {.make = make,
                                        .step = gpu_step,
                                        .read = read,
                                        .read_triangles = world_read_triangles,
                                        .first_vertex = world_first_vertex,
                                        .first_triangle = world_first_triangle,
                                        .wake = world_wake,
                                        .set_wind = set_wind,
                                        .plan = plan_rows,
                                        .save = save,
                                        .load = load,
                                        .borrow = borrow,
                                        .count = count,
                                        .device = device,
                                        .end = end};
