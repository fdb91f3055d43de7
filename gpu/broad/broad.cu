/* SPDX-License-Identifier: Apache-2.0 */
/* Makes the broad phase of a world on the device, which ref/broad/broad.c runs.
 * spec/broad/broad.md, spec/gpu.md §6 */
#include "gpu/broad/refit.cuh"

extern "C" {
#include "gpu/broad/broad.h"
#include "gpu/run/backend.h"
#include "ref/broad/cones.h"
}

/* Copies a host stream of n items to new device memory and points *p at the
 * copy. The item size is that of T. */
template <class T>
static void take_copy(struct gpu *g, enum arena_part part, T **p, int64_t n)
{
    T *from = *p;
    void *to = gpu_take(g, part, n > 0 ? n : 1, sizeof *from);
    if (to && n > 0)
        gpu_up(g, to, from, (size_t)n * sizeof *from);
    *p = (T *)to;
}

template <class T> static void take_new(struct gpu *g, T **p, int64_t n)
{
    *p = (T *)gpu_take(g, ARENA_TREE, n > 0 ? n : 1, sizeof **p);
}

static void copy_tree(struct gpu *g, struct tree *t, struct tree_map *map)
{
    take_copy(g, ARENA_TREE, &t->first, t->n);
    take_copy(g, ARENA_TREE, &t->parent, t->n);
    take_copy(g, ARENA_TREE, &t->count, t->n);
    take_copy(g, ARENA_TREE, &t->level, t->n);
    take_copy(g, ARENA_TREE, &t->rank, t->n);
    take_copy(g, ARENA_TREE, &t->mesh, t->n);
    take_copy(g, ARENA_TREE, &t->order, t->n_tri);
    take_copy(g, ARENA_TREE, &t->tri, t->n_tri);
    take_copy(g, ARENA_TREE, &t->own, t->n_tri);
    take_copy(g, ARENA_TREE, &t->one_rings.start, t->one_rings.n_start);
    take_copy(g, ARENA_TREE, &t->one_rings.opposite, t->one_rings.n_opposite);
    take_copy(g, ARENA_TREE, &t->place, t->n_cloth);
    take_copy(g, ARENA_TREE, &t->range, t->n_range);
    take_copy(g, ARENA_TREE, &map->grid, map->n_grid);
    take_copy(g, ARENA_TREE, &map->at, map->n_at);
    take_copy(g, ARENA_TREE, &map->full, t->n_cloth);
}

int gpu_broad_make(struct gpu *g, const struct broad *host, struct broad *b)
{
    *b = *host;
    b->run = &backend_gpu;
    b->on = g;
    /* The device makes all boxes itself, even if the host has made its own. */
    b->started = false;
    b->front = b->mask = b->act = b->sum = b->both = b->pair = b->kind = {};
    b->n = b->n_vf = b->n_both = 0;
    copy_tree(g, &b->tree, &b->map);
    take_copy(g, ARENA_FRONT, &b->root, b->roots);
    take_new(g, &b->box, b->tree.n);
    take_new(g, &b->stir, b->tree.n);
    take_new(g, &b->clear, b->tree.n_cloth);
    take_new(g, &b->tangents, b->n_inner);
    int status = gpu_status(g);
    if (status == DRAPE_OK)
        status = broad_begin_front(b, host->n_front > b->roots ? host->n_front
                                                               : b->roots);
    if (status != DRAPE_OK)
        return status;
    b->n_front = host->n_front;
    gpu_up(g, b->front.data, host->front.data,
           (size_t)b->n_front * sizeof *b->root);
    return gpu_status(g);
}

int gpu_broad_refitted(struct gpu *g, struct refit *s, bool now)
{
    if (now)
        gpu_read_back_keep(g, REFIT_WORDS);
    const int64_t *seen = gpu_late_seen(g);
    s->made = seen[REFIT_MADE];
    return seen[REFIT_BAD] ? DRAPE_EDATA : DRAPE_OK;
}

/* Thread k owns cloth node k. */
KERNEL all_clear_kernel(int64_t n, uint8_t *clear)
{
    ITEM(k, n);
    clear[k] = CLEAR_ALL;
}

void gpu_broad_all_clear(struct gpu *g, int64_t n, uint8_t *clear)
{
    LAUNCH(g, n, all_clear_kernel, n, clear);
}
