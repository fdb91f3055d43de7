/* SPDX-License-Identifier: Apache-2.0 */
/* A world on the device as the API sees it. Reading, saving and loading pass
 * through the streams of the host's world. spec/gpu.md §6 */
#include <stdlib.h>

extern "C" {
#include "gpu/run/gpu.h"
#include "gpu/world/state.h"
#include "ref/api/ops.h"
#include "ref/control/control.h"
#include "ref/control/edit.h"
#include "ref/control/list.h"
#include "ref/sleep/sleep.h"
#include "ref/world/checkpoint.h"
#include "ref/world/step.h"
}

static int make(const drape_def *def, struct arena *arena, struct world **world,
                drape_error *error)
{
    return gpu_make_edited(def, NULL, arena, world, error);
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

/* Lets the members of `to` point to the streams of the state that `from` has.
 */
static void point_state(struct world *to, const struct world *from)
{
    const struct state_list a = state_streams(to), b = state_streams(from);
    for (int k = 0; k < STATE_STREAMS; k++)
        *a.of[k].at = *b.of[k].at;
}

/* Returns a copy of the world in which the streams of the state are the host's.
 */
static struct world staged(const struct world *w)
{
    struct world all = *w;
    point_state(&all, w->device->host);
    return all;
}

static int fetch(const struct world *w)
{
    const struct state_list here = state_streams(w->device->host),
                            there = state_streams(w);
    struct gpu *g = w->device->gpu;
    gpu_begin(g);
    for (int k = 0; k < STATE_STREAMS; k++)
        gpu_down(g, *here.of[k].at, *there.of[k].at,
                 (size_t)there.of[k].n * sizeof(vec));
    return gpu_status(g);
}

static int read(const struct world *w, double (*x)[3], double (*v)[3])
{
    const struct world *h = w->device->host;
    size_t bytes = (size_t)w->nv * sizeof *w->x0;
    struct gpu *g = w->device->gpu;
    gpu_begin(g);
    gpu_down(g, h->x0, w->x0, x ? bytes : 0);
    gpu_down(g, h->v0, w->v0, v ? bytes : 0);
    int status = gpu_status(g);
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
        GPU_TAKE_COPY(d->gpu, w->tri, ARENA_STATE, d->host->tri, w->nt);
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
    if (w->targets.armed) {
        all.targets.to = w->home->x1;
        gpu_down(w->device->gpu, all.targets.to, w->targets.to,
                 (size_t)w->nv * sizeof *w->x0);
        status = gpu_status(w->device->gpu);
    }
    return status == DRAPE_OK ? checkpoint_save(&all, write, user) : status;
}

static int load(struct world *w, drape_read_bytes *read, void *user)
{
    struct world all = staged(w), now = *w;
    struct gpu *g = w->device->gpu;
    gpu_begin(g);
    int status = checkpoint_load(&all, read, user);
    w->targets.from = all.targets.from; /* streams that may have been taken */
    w->targets.to = all.targets.to;
    w->to = all.to;
    w->lagrange = all.lagrange;
    if (status != DRAPE_OK)
        return status;
    const struct state_list here = state_streams(&all),
                            there = state_streams(w);
    for (int k = 0; k < STATE_STREAMS; k++)
        gpu_up(g, *there.of[k].at, *here.of[k].at,
               (size_t)here.of[k].n * sizeof(vec));
    /* no step writes x1 and v1 of what never moves */
    size_t bytes = (size_t)w->nv * sizeof *w->x0;
    gpu_up(g, w->x1, all.x0, bytes);
    gpu_up(g, w->v1, all.v0, bytes);
    gpu_wait(g);
    *w = all;
    point_state(w, &now);
    return gpu_status(g);
}

/* A larger world leaves nothing of the device idle. */
enum { TOGETHER_MOST = 1 << 15 };

/* A trace is the caller's, who need not expect another stack. */
static int place(const struct world *w)
{
    bool may = w->nv <= TOGETHER_MOST && !w->tracing;
    return may ? gpu_device(w->device->gpu) + 1 : -1;
}

static int together(struct world *const *w, int n, int threads,
                    void (*work)(void *with, int k), void *with)
{
    struct gpu **g = (struct gpu **)malloc((size_t)n * sizeof *g);
    for (int k = 0; k < n && g; k++)
        g[k] = w[k]->device->gpu;
    int status = g ? gpu_batch(g, n, threads, work, with) : (int)DRAPE_ENOMEM;
    free(g);
    return status;
}

const struct world_ops world_ops_gpu = {.make = make,
                                        .step = step_advance,
                                        .read = read,
                                        .read_triangles = read_triangles,
                                        .clock = state_clock,
                                        .material = state_material,
                                        .wind = state_wind,
                                        .gravity = state_gravity,
                                        .first_vertex = state_first_vertex,
                                        .first_triangle = state_first_triangle,
                                        .wake = sleep_wake,
                                        .set_wind = control_wind,
                                        .control = CONTROL_OPS,
                                        .edit = EDIT_OPS(gpu_make_edited),
                                        .contacts = list_contacts,
                                        .plan = plan_rows,
                                        .save = save,
                                        .load = load,
                                        .borrow = borrow,
                                        .place = place,
                                        .together = together,
                                        .count = count,
                                        .device = device,
                                        .end = end};
