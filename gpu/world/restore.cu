/* SPDX-License-Identifier: Apache-2.0 */
/* What a step that fails in a later slice goes back to: ref/world/restore.c
 * with streams on the device. spec/world/step.md §7 */
#include "gpu/run/gpu.cuh"
#include "gpu/world/collide.cuh"

static vec *take(struct gpu_world *w, vec *had, int64_t n)
{
    return had ? had : (vec *)gpu_take(w->gpu, ARENA_STATE, n, sizeof(vec));
}

/* What is not there yet; a try before may have got a part of it. */
static int take_start(struct gpu_world *w)
{
    struct world *h = w->host;
    struct start *s = &w->start;
    s->x = take(w, s->x, h->nv);
    s->v = take(w, s->v, h->nv);
    if (w->past_x) {
        s->past_x = take(w, s->past_x, h->nc);
        s->past_v = take(w, s->past_v, h->nc);
    }
    if (w->press)
        s->press = take(w, s->press, h->nc);
    if (!s->watch)
        s->watch = (double(*)[2])arena_take(h->arena, ARENA_OTHER,
                                            h->def.n_cloths, sizeof *s->watch);
    return h->arena->failed ? DRAPE_ENOMEM : gpu_status(w->gpu);
}

int gpu_slice_save(struct gpu_world *w)
{
    struct world *h = w->host;
    struct start *s = &w->start;
    size_t n = (size_t)h->nv * sizeof(vec);
    size_t past = w->past_x ? (size_t)h->nc * sizeof(vec) : 0;
    size_t press = w->press ? (size_t)h->nc * sizeof(vec) : 0;
    size_t watch = (size_t)h->def.n_cloths * sizeof *s->watch;
    int status = take_start(w);
    if (status != DRAPE_OK)
        return status;
    gpu_copy(w->gpu, s->x, w->x0, n);
    gpu_copy(w->gpu, s->v, w->v0, n);
    gpu_copy(w->gpu, s->past_x, w->past_x, past);
    gpu_copy(w->gpu, s->past_v, w->past_v, past);
    gpu_copy(w->gpu, s->press, w->press, press);
    memcpy(s->watch, h->watch, watch);
    s->pressed = h->pressed;
    s->past = h->past;
    s->resting = h->resting;
    s->asleep = h->asleep;
    s->near = h->near;
    return gpu_status(w->gpu);
}

void gpu_slice_restore(struct gpu_world *w)
{
    struct world *h = w->host;
    const struct start *s = &w->start;
    gpu_begin(w->gpu); /* what failed may have been short memory */
    size_t n = (size_t)h->nv * sizeof(vec);
    size_t past = w->past_x ? (size_t)h->nc * sizeof(vec) : 0;
    size_t press = w->press ? (size_t)h->nc * sizeof(vec) : 0;
    gpu_copy(w->gpu, w->x0, s->x, n);
    gpu_copy(w->gpu, w->v0, s->v, n);
    gpu_copy(w->gpu, w->past_x, s->past_x, past);
    gpu_copy(w->gpu, w->past_v, s->past_v, past);
    gpu_copy(w->gpu, w->press, s->press, press);
    memcpy(h->watch, s->watch, (size_t)h->def.n_cloths * sizeof *s->watch);
    h->pressed = s->pressed;
    h->past = s->past;
    h->resting = s->resting;
    h->asleep = s->asleep;
    h->near = s->near;
}
