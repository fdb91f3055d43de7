/* SPDX-License-Identifier: Apache-2.0 */
/* Makes a world on the device: ref/world/world.c makes it on the host, then its
 * streams are copied to the device one by one. Reading, saving and loading pass
 * through the host's streams. spec/gpu.md §6 */
#include <stdio.h>

#include "gpu/cloth/motion.cuh"
#include "gpu/compare/blas.h"

extern "C" {
#include "gpu/broad/broad.h"
#include "ref/control/control.h"
#include "ref/control/heir.h"
#include "ref/control/list.h"
#include "ref/world/step.h"
}

/* Takes a stream on the device and copies the host's stream to it; host: NULL
 * for a stream of zeros. Returns NULL if there is no memory. */
static void *give(struct gpu_world *d, enum arena_part part, const void *host,
                  int64_t n, size_t size)
{
    void *p = gpu_take(d->gpu, part, n, size);
    if (p && host)
        gpu_up(d->gpu, p, host, (size_t)n * size);
    return p;
}

/* GIVE(p, part, host, n) sets p to a stream of n items of p's type. */
#define GIVE(p, part, host, n)                                                 \
    (p) = (decltype(p))give(d, part, host, n, sizeof *(p))

static void give_state(struct gpu_world *d)
{
    const struct world *h = d->host;
    struct world *w = &d->world;
    GIVE(w->x0, ARENA_STATE, h->x0, h->nv);
    GIVE(w->v0, ARENA_STATE, h->v0, h->nv);
    GIVE(w->x1, ARENA_STATE, h->x0, h->nv);
    GIVE(w->v1, ARENA_STATE, h->v0, h->nv);
    GIVE(w->w, ARENA_STATE, h->w, h->nv);
    GIVE(w->body, ARENA_STATE, h->body, h->nv);
    GIVE(w->surface, ARENA_STATE, h->surface,
         h->def.n_cloths + h->def.n_obstacles);
    GIVE(w->posed, ARENA_OTHER, h->pose, h->def.n_motions);
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
    w->tri = NULL; /* borrow() takes it if nothing can collide */
}

/* Whether the integrator reads w->to: an implicit one only if there are pins.
 */
static bool reads_to(const struct world *h)
{
    bool reads = !h->plan.implicit;
    for (int k = 0; k < h->def.n_cloths; k++)
        reads |= h->sheet[k].cloth.n_pinned > 0;
    return reads;
}

static void give_motion(struct gpu_world *d)
{
    const struct world *h = d->host;
    d->world.to = NULL;
    if (reads_to(h))
        GIVE(d->world.to, ARENA_STATE, h->to, h->nc);
    if (!h->plan.implicit)
        return;
    GIVE(d->star, ARENA_SOLVER, NULL, h->nc);
    GIVE(d->b, ARENA_SOLVER, NULL, h->plan.collides ? h->nv : h->nc);
}

static void give_place(struct gpu_world *d, enum arena_part part,
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
    k->pose = d->world.posed;
}

/* Lays out streams one behind the other in one block; without a block it only
 * adds up their sizes. */
struct row {
    char *block;
    size_t at;
};

static void *next_in(struct row *row, int64_t n, size_t size)
{
    size_t align = 256, at = row->at; /* the alignment of cudaMalloc */
    row->at = (at + (size_t)n * size + align - 1) / align * align;
    return row->block ? row->block + at : NULL;
}

#define NEXT(p, n) (p) = (decltype(p))next_in(&row, n, sizeof *(p))

/* Lays out the streams of a cloth's solver in one block, or without a block
 * finds its size. r comes first, since the first contacts of a slice read it;
 * everything after r is lent between solves. pool of multigrid lacks the part
 * for the finest grid that p and q lend it. p and q lie before the
 * motion's streams, of which the first, the force, is only read by rhs. */
static struct row lay_out(struct sheet *s, int64_t vecs, char *block)
{
    struct row row = {block, 0};
    struct pcg *p = &s->solver.pcg;
    int64_t lent = p->grid.n_pool ? p->count : 0;
    NEXT(p->r, p->count);
    NEXT(p->cdf, p->n_cdf);
    NEXT(p->diagonal, p->n_cdf ? p->count : 0);
    NEXT(p->factor, p->count);
    NEXT(p->low, p->count);
    NEXT(p->s, p->count);
    NEXT(p->grid.pool, p->grid.n_pool - lent);
    NEXT(p->grid.room, p->grid.n_room);
    NEXT(p->grid.live, p->grid.n_live);
    NEXT(p->p, (2 + vecs) * p->count);
    return row;
}

static void give_solver(struct gpu_world *d, struct sheet *s, int64_t vecs)
{
    struct pcg *p = &s->solver.pcg;
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
    gpu_lend(d->gpu, from, (size_t)((char *)to - (char *)from));
}

static void give_sheet(struct gpu_world *d, int k)
{
    const struct sheet *h = &d->host->sheet[k];
    struct sheet *s = &d->world.sheet[k];
    struct gpu_sheet *more = s->device;
    struct cloth *c = &s->cloth;
    struct dynamics *m = &s->dynamics;
    struct pcg *p = &s->solver.pcg;
    *s = *h;
    s->device = more;
    c->tri = NULL;
    GIVE(c->cell, ARENA_CLOTH, h->cloth.cell, c->count);
    GIVE(c->springs, ARENA_CLOTH, h->cloth.springs, c->count);
    GIVE(c->beside, ARENA_CLOTH, h->cloth.beside, c->count);
    GIVE(c->fixed, ARENA_CLOTH, h->cloth.fixed, c->count);
    GIVE(c->mass, ARENA_CLOTH, h->cloth.mass, c->count);
    GIVE(more->law, ARENA_CLOTH, c->law, SPRINGS);
    GIVE(more->piece, ARENA_CLOTH, c->piece, PIECES);
    GIVE(more->triple, ARENA_CLOTH, c->triple, TRIPLES);
    GIVE(s->pinned, ARENA_CLOTH, h->pinned, h->pins.n);
    give_place(d, ARENA_CLOTH, &h->pins, &s->pins);
    GIVE(s->pins.x, ARENA_CLOTH, h->pins.x, h->pins.n);
    m->cloth = c;
    int64_t vecs = motion_vecs(m);
    GIVE(m->chunk, ARENA_SOLVER, NULL, 3 * sum_chunks(c->count));
    if (!d->world.plan.implicit) {
        GIVE(m->work, ARENA_SOLVER, NULL, (vecs + motion_spares(m)) * c->count);
        return;
    }
    more->star = d->star + s->first;
    more->b = d->b + s->first;
    GIVE(m->block, ARENA_SOLVER, NULL, SPRINGS * c->count);
    if (m->newton > 1)
        GIVE(m->kept, ARENA_SOLVER, NULL, 2 * c->count);
    if (p->n_thin)
        GIVE(m->thin, ARENA_SOLVER, NULL, p->n_thin);
    if (gpu_rates_help(d->gpu, p))
        GIVE(more->rate, ARENA_SOLVER, NULL, SPRINGS * RATES_PITCH(c->count));
    p->mass = c->mass;
    p->fixed = c->fixed;
    give_solver(d, s, vecs);
}

static void give_prop(struct gpu_world *d, int k)
{
    const struct prop *h = &d->host->prop[k];
    struct prop *p = &d->world.prop[k];
    *p = *h;
    give_place(d, ARENA_OBSTACLE, &h->place, &p->place);
    if (h->frames)
        GIVE(p->frame, ARENA_OBSTACLE, h->frame, 3 * h->place.n * h->frames);
}

static int give_response(struct gpu_world *d)
{
    struct world *w = &d->world;
    struct response *c = &w->response;
    c->run = w->run;
    c->on = w->on;
    c->w = w->w;
    c->skin.of = w->body;
    c->skin.surface = w->surface;
    c->fan = w->broad.tree.fan;
    c->user = w;
    GIVE(c->u, ARENA_RESPONSE, NULL, w->nv);
    GIVE(c->touched, ARENA_RESPONSE, NULL, w->nv);
    GIVE(c->rolled, ARENA_RESPONSE, NULL, w->nv);
    GIVE(c->start, ARENA_RESPONSE, NULL, w->nv + 1);
    return w->plan.implicit ? gpu_turn_make(d) : gpu_status(d->gpu);
}

/* Opens the device and makes *world, the world that is stepped: a copy of the
 * host's world h, whose streams are replaced one by one later. */
static int open_device(struct world *h, struct world **world,
                       drape_error *error)
{
    int status;
    struct gpu_world *d =
        (struct gpu_world *)arena_take(h->arena, ARENA_OTHER, 1, sizeof *d);
    if (!d)
        return DRAPE_ENOMEM;
    d->host = h;
    d->world = *h;
    d->world.home = h;
    d->world.device = d;
    *world = &d->world;
    d->gpu = gpu_open(&h->def, &status);
    if (status == DRAPE_EDEVICE && error)
        snprintf(error->text, sizeof error->text,
                 "backend gpu: there is no device here that can be used");
    if (!d->gpu)
        return status;
    d->world.run = &backend_gpu;
    d->world.on = d->gpu;
    d->world.held = gpu_held(d->gpu);
    if (h->def.solver == DRAPE_CUBLAS)
        status = blas_open(d->gpu);
    if (status == DRAPE_EDEVICE && error)
        snprintf(error->text, sizeof error->text,
                 "solver cublas: libcublas cannot be found or used");
    return status;
}

/* Takes the structs of cloths and obstacles of the world that is stepped. */
static int take_bodies(struct world *w)
{
    const drape_def *def = &w->def;
    w->sheet = (struct sheet *)arena_take(w->arena, ARENA_OTHER, def->n_cloths,
                                          sizeof *w->sheet);
    w->prop = (struct prop *)arena_take(w->arena, ARENA_OTHER, def->n_obstacles,
                                        sizeof *w->prop);
    struct gpu_sheet *more = (struct gpu_sheet *)arena_take(
        w->arena, ARENA_OTHER, def->n_cloths, sizeof *more);
    if (!w->sheet || !w->prop || !more)
        return DRAPE_ENOMEM;
    for (int k = 0; k < def->n_cloths; k++)
        w->sheet[k].device = &more[k];
    return DRAPE_OK;
}

static int make_heir(const drape_def *def, const struct heir *heir,
                     struct arena *arena, struct world **world,
                     drape_error *error)
{
    int status = world_make_heir(def, heir, arena, world, error);
    struct world *h = *world;
    if (status == DRAPE_OK)
        status = open_device(h, world, error);
    if (status == DRAPE_OK)
        status = take_bodies(*world);
    if (status != DRAPE_OK)
        return status;
    struct world *w = *world;
    struct gpu_world *d = w->device;
    give_state(d);
    give_motion(d);
    for (int k = 0; k < def->n_cloths; k++)
        give_sheet(d, k);
    for (int k = 0; k < def->n_obstacles; k++)
        give_prop(d, k);
    status = gpu_status(d->gpu);
    if (h->tracing) /* taken now, so that no step fails for want of it */
        gpu_aside(d->gpu, (size_t)h->nv * sizeof(vec));
    if (status == DRAPE_OK && w->plan.collides)
        status = gpu_broad_make(d->gpu, &h->broad, &w->broad);
    if (status == DRAPE_OK && w->plan.collides) {
        w->tri = (int32_t(*)[3])w->broad.tree.tri;
        status = give_response(d);
    }
    gpu_wait(d->gpu);
    return status == DRAPE_OK ? gpu_status(d->gpu) : status;
}

static int make(const drape_def *def, struct arena *arena, struct world **world,
                drape_error *error)
{
    return make_heir(def, NULL, arena, world, error);
}

static void count(const struct world *w, drape_memory *m)
{
    if (w->device && w->device->gpu) /* else its making failed */
        gpu_count(w->device->gpu, m);
}

static void end(struct world *w)
{
    if (w->device)
        gpu_close(w->device->gpu);
}

/* Returns a copy of the world in which the streams of the state are the host's.
 */
static struct world staged(const struct world *w)
{
    const struct world *h = w->device->host;
    struct world all = *w;
    all.x0 = h->x0;
    all.v0 = h->v0;
    all.past_x = h->past_x;
    all.past_v = h->past_v;
    all.press = h->press;
    return all;
}

static int fetch(const struct world *w)
{
    const struct world *h = w->device->host;
    struct gpu *g = w->device->gpu;
    size_t bytes = (size_t)w->nv * sizeof *w->x0;
    size_t past = w->past_x ? (size_t)w->nc * sizeof *w->past_x : 0;
    size_t press = w->press ? (size_t)w->nc * sizeof *w->press : 0;
    gpu_begin(g);
    gpu_down(g, h->x0, w->x0, bytes);
    gpu_down(g, h->v0, w->v0, bytes);
    gpu_down(g, h->past_x, w->past_x, past);
    gpu_down(g, h->past_v, w->past_v, past);
    gpu_down(g, h->press, w->press, press);
    return gpu_status(g);
}

static int read(const struct world *w, double (*x)[3], double (*v)[3])
{
    int status = fetch(w);
    return status == DRAPE_OK ? world_read(w->device->host, x, v) : status;
}

static void read_triangles(const struct world *w, int32_t (*tri)[3])
{
    world_read_triangles(w->device->host, tri);
}

static int borrow(struct world *w, drape_view *view)
{
    struct gpu_world *d = w->device;
    gpu_begin(d->gpu);
    if (!w->tri)
        GIVE(w->tri, ARENA_STATE, d->host->tri, w->nt);
    int status = gpu_status(d->gpu);
    if (status != DRAPE_OK)
        return status;
    view->x = w->x0;
    view->v = w->v0;
    view->tri = (const int32_t(*)[3])w->tri;
    view->device = gpu_device(d->gpu);
    view->stream = gpu_stream(d->gpu);
    return DRAPE_OK;
}

static const char *device(const struct world *w)
{
    return gpu_name(w->device->gpu);
}

static int save(const struct world *w, drape_write *write, void *user)
{
    struct world all = staged(w);
    int status = fetch(w);
    if (w->told.armed) {
        all.told.to = w->home->x1;
        gpu_down(w->device->gpu, all.told.to, w->told.to,
                 (size_t)w->nv * sizeof *w->x0);
        status = gpu_status(w->device->gpu);
    }
    return status == DRAPE_OK ? checkpoint_save(&all, write, user) : status;
}

static int load(struct world *w, drape_read_bytes *read, void *user)
{
    struct world all = staged(w), now = *w;
    struct gpu *g = w->device->gpu;
    int status = checkpoint_load(&all, read, user);
    w->told.from = all.told.from; /* streams that may have been taken */
    w->told.to = all.told.to;
    w->to = all.to;
    if (status != DRAPE_OK)
        return status;
    gpu_begin(g);
    size_t bytes = (size_t)w->nv * sizeof *w->x0;
    size_t past = w->past_x ? (size_t)w->nc * sizeof *w->past_x : 0;
    size_t press = w->press ? (size_t)w->nc * sizeof *w->press : 0;
    gpu_up(g, w->x0, all.x0, bytes);
    gpu_up(g, w->v0, all.v0, bytes);
    /* no step writes x1 and v1 of what never moves */
    gpu_up(g, w->x1, all.x0, bytes);
    gpu_up(g, w->v1, all.v0, bytes);
    gpu_up(g, w->past_x, all.past_x, past);
    gpu_up(g, w->past_v, all.past_v, past);
    gpu_up(g, w->press, all.press, press);
    gpu_wait(g);
    *w = all;
    w->x0 = now.x0;
    w->v0 = now.v0;
    w->past_x = now.past_x;
    w->past_v = now.past_v;
    w->press = now.press;
    return gpu_status(g);
}

const struct world_ops world_ops_gpu = {.make = make,
                                        .step = step_advance,
                                        .read = read,
                                        .read_triangles = read_triangles,
                                        .first_vertex = world_first_vertex,
                                        .first_triangle = world_first_triangle,
                                        .wake = world_wake,
                                        .set_wind = world_set_wind,
                                        .control = CONTROL_OPS,
                                        .heir = HEIR_OPS(make_heir),
                                        .contacts = list_contacts,
                                        .plan = plan_rows,
                                        .save = save,
                                        .load = load,
                                        .borrow = borrow,
                                        .count = count,
                                        .device = device,
                                        .end = end};
