/* SPDX-License-Identifier: Apache-2.0 */
/* Whether the state that a step ends in intersects: ref/world/ending.c with
 * streams on the device. spec/world/step.md §11 */
#include "gpu/run/gpu.cuh"
#include "gpu/world/world.h"

/* take(&pointer, n): the stream, if it is not there yet. */
template <typename T> static void take(struct gpu *g, T **p, int64_t n)
{
    if (!*p)
        *p = (T *)gpu_take(g, ARENA_RESPONSE, n, sizeof(T));
}

static int take_streams(struct gpu_world *w, struct audit *s)
{
    int64_t nt = w->host->nt;
    s->n_nodes = ref_audit_nodes(nt);
    for (int k = 0; k < 2; k++) {
        take(w->gpu, &s->key[k], nt);
        take(w->gpu, &s->order[k], nt);
    }
    take(w->gpu, &s->node, s->n_nodes);
    take(w->gpu, &s->degenerate, nt);
    take(w->gpu, &w->group, nt);
    return gpu_status(w->gpu);
}

/* Thread k owns triangle k: writes whether it is a cloth's. */
static __global__ void __launch_bounds__(GPU_BLOCK)
    ending_group_kernel(int64_t nt, int64_t cloths, int32_t *group)
{
    ITEM(k, nt);
    group[k] = k < cloths;
}

int gpu_ending_count(struct gpu_world *w, int64_t *found)
{
    const struct world *h = w->host;
    struct audit *s = &w->ending;
    int status = take_streams(w, s);
    if (status != DRAPE_OK)
        return status;
    LAUNCH(w->gpu, h->nt, ending_group_kernel, h->nt, h->ntc, w->group);
    s->nv = h->nv;
    s->nt = h->nt;
    s->x = w->x0;
    s->tri = w->broad.tree.tri;
    s->group = w->group;
    s->across = !h->plan.self;
    s->cap = 0; /* their number is all that is asked for */
    status = gpu_audit(w->gpu, s);
    *found = s->found;
    return status == DRAPE_EFULL ? DRAPE_OK : status;
}
