/* SPDX-License-Identifier: Apache-2.0 */
/* Makes a world on the device: ref/world/world.c makes it on the host, then its
 * streams are copied to the device one by one. spec/gpu.md §6 */
#include <stdio.h>
#include <string.h>

extern "C" {
#include "gpu/broad/broad.h"
#include "gpu/compare/blas.h"
#include "gpu/run/backend.h"
#include "gpu/world/sheet.h"
#include "gpu/world/state.h"
#include "gpu/world/systems.h"
#include "ref/world/air.h"
}

/* The streams of seams, but for those of the state. */
static void give_seams(struct gpu_world *d)
{
    const struct seams *h = &d->host->seams;
    struct seams *s = &d->world.seams;
    if (h->n == 0)
        return;
    GPU_TAKE_COPY(d->gpu, s->point, ARENA_STATE, h->point, h->n);
    GPU_TAKE_COPY(d->gpu, s->next, ARENA_STATE, NULL, h->n);
    GPU_TAKE_COPY(d->gpu, s->hinge, ARENA_STATE, h->hinge, h->n_hinges);
    GPU_TAKE_COPY(d->gpu, s->aside, ARENA_RESPONSE, NULL, seams_contacts(h));
    GPU_TAKE_COPY(d->gpu, s->start, ARENA_PAIRS, h->start, h->n_start);
    GPU_TAKE_COPY(d->gpu, s->sewn, ARENA_PAIRS, h->sewn, h->n_sewn);
}

static void give_state(struct gpu_world *d)
{
    const struct world *h = d->host;
    struct world *w = &d->world;
    const struct state_list here = state_streams(h), there = state_streams(w);
    for (int k = 0; k < STATE_STREAMS; k++)
        if (here.of[k].n)
            *there.of[k].at = (vec *)gpu_take_copy(
                d->gpu, ARENA_STATE, *here.of[k].at, here.of[k].n, sizeof(vec));
    GPU_TAKE_COPY(d->gpu, w->x1, ARENA_STATE, h->x0, h->nv);
    GPU_TAKE_COPY(d->gpu, w->v1, ARENA_STATE, h->v0, h->nv);
    GPU_TAKE_COPY(d->gpu, w->w, ARENA_STATE, h->w, h->nv);
    GPU_TAKE_COPY(d->gpu, w->body, ARENA_STATE, h->body, h->nv);
    GPU_TAKE_COPY(d->gpu, w->surface, ARENA_STATE, h->surface,
                  h->def.n_cloths + h->def.n_obstacles);
    GPU_TAKE_COPY(d->gpu, w->posed, ARENA_OTHER, h->pose, h->def.n_motions);
    if (h->plan.history && h->plan.collides) {
        GPU_TAKE_COPY(d->gpu, w->free_x, ARENA_STATE, NULL, h->nc);
        GPU_TAKE_COPY(d->gpu, w->free_v, ARENA_STATE, NULL, h->nc);
    }
    give_seams(d);
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
        GPU_TAKE_COPY(d->gpu, d->world.to, ARENA_STATE, h->to, h->nc);
    if (!h->plan.implicit)
        return;
    GPU_TAKE_COPY(d->gpu, d->star, ARENA_SOLVER, NULL, h->nc);
    GPU_TAKE_COPY(d->gpu, d->b, ARENA_SOLVER, NULL, h->nc);
}

static void give_prop(struct gpu_world *d, int k)
{
    const struct prop *h = &d->host->prop[k];
    struct prop *p = &d->world.prop[k];
    *p = *h;
    gpu_kinematics_make(d->gpu, ARENA_OBSTACLE, &h->place, d->world.posed,
                        &p->place);
    if (h->frame)
        GPU_TAKE_COPY(d->gpu, p->frame, ARENA_OBSTACLE, h->frame,
                      3 * h->place.n * h->frames.count);
}

static int give_response(struct gpu_world *d)
{
    struct world *w = &d->world;
    struct response *c = &w->response;
    c->run = w->run;
    c->on = w->on;
    c->w = w->w;
    c->surfaces.of = w->body;
    c->surfaces.surface = w->surface;
    c->one_rings = w->broad.tree.one_rings;
    c->user = w;
    GPU_TAKE_COPY(d->gpu, c->u, ARENA_RESPONSE, NULL, w->nv);
    GPU_TAKE_COPY(d->gpu, c->touched, ARENA_RESPONSE, NULL, w->nv);
    GPU_TAKE_COPY(d->gpu, c->rolled, ARENA_RESPONSE, NULL, w->nv);
    GPU_TAKE_COPY(d->gpu, c->start, ARENA_RESPONSE, NULL, w->nv + 1);
    GPU_TAKE_COPY(d->gpu, c->first, ARENA_RESPONSE, NULL, w->nv);
    return w->plan.solves ? gpu_systems_streams(d) : gpu_status(d->gpu);
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
    return gpu_systems_make(w->device);
}

int gpu_make_edited(const drape_def *def, const struct edited *edited,
                    struct arena *arena, struct world **world,
                    drape_error *error)
{
    int status = world_make_edited(def, edited, arena, world, error);
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
        gpu_sheet_make(d, k);
    for (int k = 0; k < def->n_obstacles; k++)
        give_prop(d, k);
    status = w->plan.wind ? air_take(w) : gpu_status(d->gpu);
    air_set(w, &w->def.wind);
    if (h->tracing) /* taken now, so that no step fails for want of it */
        gpu_aside(d->gpu, (size_t)h->nv * sizeof(vec));
    if (status == DRAPE_OK && w->plan.collides)
        status = gpu_broad_make(d->gpu, &h->broad, &w->broad);
    if (status == DRAPE_OK && w->plan.collides) {
        w->tri = (int32_t(*)[3])w->broad.tree.tri;
        w->broad.start = w->seams.start;
        w->broad.sewn = w->seams.sewn;
        status = give_response(d);
    }
    gpu_wait(d->gpu);
    return status == DRAPE_OK ? gpu_status(d->gpu) : status;
}
