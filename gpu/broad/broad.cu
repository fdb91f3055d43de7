/* SPDX-License-Identifier: Apache-2.0 */
/* Runs the stages of the broad phase on the device and grows their streams when
 * a capacity is exceeded. spec/broad/broad.md, spec/gpu.md §6 */
#include "gpu/broad/bvtt.cuh"
#include "gpu/broad/refit.cuh"

extern "C" {
#include "gpu/broad/broad.h"
#include "gpu/run/backend.h"
#include "ref/base/trace.h"
#include "ref/broad/cones.h"
#include "ref/broad/extent.h"
#include "ref/broad/features.h"
#include "ref/broad/front.h"
#include "ref/broad/walk.h"
}

/* Memory. Growing a pool loses its contents. */

static int grow(struct gpu *g, struct broad_pool *p, enum arena_part part,
                int64_t need, size_t size)
{
    if (need <= p->cap)
        return DRAPE_OK;
    int64_t cap = gpu_capacity(g, need);
    gpu_give(g, p->data);
    p->cap = 0;
    p->data = part == ARENA_FRONT ? gpu_take(g, part, cap, size)
                                  : gpu_borrow(g, part, cap, size);
    if (!p->data) /* out of memory, or the device failed */
        return gpu_status(g);
    p->cap = cap;
    return DRAPE_OK;
}

/* Grows a pool of a query or its candidates, which are read before contacts are
 * solved. Its memory is reported as ARENA_PAIRS. */
static int grow_pairs(struct gpu *g, struct broad_pool *p, int64_t need,
                      size_t size)
{
    return grow(g, p, ARENA_PAIRS, need, size);
}

/* Grows the scratch streams of front and walk to `need` node pairs. */
static int grow_scratch(struct gpu *g, struct broad *b, int64_t need)
{
    int status = grow_pairs(g, &b->pair, need, 2 * sizeof(struct duo));
    if (status == DRAPE_OK)
        status = grow_pairs(g, &b->mask, need, sizeof(uint16_t));
    if (status == DRAPE_OK)
        status = grow_pairs(g, &b->act, need, sizeof(uint8_t));
    return status;
}

/* Resets the front to the root pairs, with a capacity of `need` pairs. */
static int begin_front(struct gpu *g, struct broad *b, int64_t need)
{
    int status = grow(g, &b->front, ARENA_FRONT, need, sizeof(struct duo));
    if (status == DRAPE_OK)
        status = grow_scratch(g, b, b->front.cap);
    if (status != DRAPE_OK)
        return status;
    b->n_front = b->roots;
    gpu_copy(g, b->front.data, b->root, (size_t)b->roots * sizeof *b->root);
    return gpu_status(g);
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
    b->arena = NULL;
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
        status = begin_front(
            g, b, host->n_front > b->roots ? host->n_front : b->roots);
    if (status != DRAPE_OK)
        return status;
    b->n_front = host->n_front;
    gpu_up(g, b->front.data, host->front.data,
           (size_t)b->n_front * sizeof(struct duo));
    return gpu_status(g);
}

/* Whether cloths have fallen asleep whose boxes are of a motion. */
static bool makes_all(const struct broad *b)
{
    return b->dozes && !(b->made && b->started);
}

/* Queues refit and cones. Their status is known only after the readback of
 * walk: refitted(). */
static void refit(struct gpu *g, struct broad *b)
{
    struct refit fit = {};
    fit.tree = b->tree;
    fit.nv = b->nv;
    fit.x0 = b->x0;
    fit.x1 = b->x1;
    fit.n_moved = b->later || b->dozes ? b->nv : 0;
    fit.moved = b->moved;
    fit.all = !b->started || (b->restless && !b->later);
    fit.every = makes_all(b);
    fit.box = b->box;
    fit.stir = b->stir;
    gpu_refit_queue(g, &fit, gpu_late_words(g));
    gpu_trace(g, b->trace, "refit", b->box, (size_t)b->tree.n * sizeof *b->box);
}

static int refitted(const struct gpu *g, struct broad *b)
{
    const int64_t *seen = gpu_late_seen(g);
    int64_t still = b->started ? 0 : b->still;
    int64_t made = seen[REFIT_BAD] ? 0 : seen[REFIT_MADE] - still;
    b->queries++;
    b->refitted += made;
    b->kept += b->tree.n - made;
    b->started = b->started || !seen[REFIT_BAD];
    b->made = b->made || (b->dozes && !seen[REFIT_BAD]);
    return seen[REFIT_BAD] ? DRAPE_EDATA : DRAPE_OK;
}

/* Thread k owns cloth node k. What does not stir is compared with nothing of
 * itself. */
KERNEL all_clear_kernel(int64_t n, uint8_t *clear)
{
    ITEM(k, n);
    clear[k] = CLEAR_ALL;
}

/* every: the boxes of all nodes were made. */
static int cones(struct gpu *g, struct broad *b, bool every)
{
    struct cones s = {};
    if (every)
        LAUNCH(g, b->tree.n_cloth, all_clear_kernel, b->tree.n_cloth, b->clear);
    s.tree = b->tree;
    s.map = b->map;
    s.nv = b->nv;
    s.x0 = b->x0;
    s.x1 = b->x1;
    s.r = b->r;
    s.stir = b->stir;
    s.n_inner = b->n_inner;
    s.tangents = b->tangents;
    s.clear = b->clear;
    int status = gpu_cones(g, &s);
    gpu_trace(g, b->trace, "cones", b->clear, (size_t)b->tree.n_cloth);
    return status;
}

static struct bvtt bvtt_of(const struct broad *b)
{
    struct bvtt in = {};
    in.tree = b->tree;
    in.box = b->box;
    in.clear = b->clear;
    in.r = b->r;
    return in;
}

/* Moves the front to where the refitted boxes put it. */
static int update_front(struct gpu *g, struct broad *b)
{
    struct front s = {};
    s.in = bvtt_of(b);
    s.stop = b->stop;
    if (!b->n_front && begin_front(g, b, b->roots) != DRAPE_OK)
        return gpu_status(g);
    for (;;) {
        s.cap = b->front.cap;
        s.n = b->n_front;
        s.pair = (int32_t(*)[2])b->front.data;
        s.other = (int32_t(*)[2])b->pair.data;
        s.act = (uint8_t *)b->act.data;
        s.act_other = (uint8_t *)b->mask.data;
        int status = gpu_front(g, &s);
        b->n_front = s.n;
        b->front_visited = s.visited;
        if (status != DRAPE_EFULL) {
            gpu_trace(g, b->trace, "front", b->front.data,
                      (size_t)s.n * sizeof(struct duo));
            return status;
        }
        status = begin_front(g, b, s.need);
        if (status != DRAPE_OK)
            return status;
    }
}

/* Runs stage walk, growing its streams until the triangle pairs below the front
 * fit. */
static int walk(struct gpu *g, struct broad *b)
{
    struct walk s = {};
    s.in = bvtt_of(b);
    s.nv = b->nv;
    s.x0 = b->x0;
    s.x1 = b->x1;
    s.stir = b->stir;
    s.n_front = b->n_front;
    s.front = (const int32_t(*)[2])b->front.data;
    for (;;) {
        s.cap = b->pair.cap < b->mask.cap ? b->pair.cap : b->mask.cap;
        s.pair = (int32_t(*)[2])b->pair.data;
        s.other = s.pair + s.cap;
        s.mask = (uint16_t *)b->mask.data;
        s.cap_tri = b->both.cap;
        s.tri = (int32_t(*)[2])b->both.data;
        int status = gpu_walk(g, &s);
        b->n_both = s.n_tri;
        b->visited = s.visited;
        if (status != DRAPE_EFULL) {
            b->walked += s.visited;
            b->cleared += s.cleared;
            gpu_trace(g, b->trace, "walk", s.tri,
                      (size_t)s.n_tri * sizeof(struct duo));
            return status;
        }
        status = grow_scratch(g, b, s.need);
        if (status == DRAPE_OK)
            status = grow_pairs(g, &b->both, s.need_tri, sizeof(struct duo));
        if (status != DRAPE_OK)
            return status;
    }
}

/* Runs stage features, whose inputs are set, growing its streams until the
 * candidates fit. */
static int find(struct gpu *g, struct broad *b, struct features *s)
{
    int status = grow_pairs(g, &b->mask, s->n, sizeof *s->mask);
    if (status == DRAPE_OK)
        status = grow_pairs(g, &b->sum, 2 * blocks_of(s->n), sizeof *s->sum);
    while (status == DRAPE_OK) {
        s->mask = (uint16_t *)b->mask.data;
        s->sum = (int64_t *)b->sum.data;
        s->cap = b->pair.cap < b->kind.cap ? b->pair.cap : b->kind.cap;
        s->pair = (int32_t(*)[4])b->pair.data;
        s->kind = (uint8_t *)b->kind.data;
        status = gpu_features(g, s);
        if (status != DRAPE_EFULL)
            break;
        status = grow_pairs(g, &b->pair, s->need, sizeof *s->pair);
        if (status == DRAPE_OK)
            status = grow_pairs(g, &b->kind, s->need, sizeof *s->kind);
    }
    gpu_trace(g, b->trace, "features", s->pair,
              (size_t)s->n_pair * sizeof *s->pair);
    return status;
}

static int candidates(struct gpu *g, struct broad *b)
{
    struct features s = {};
    s.nv = b->nv;
    s.nt = b->tree.n_tri;
    s.n = b->n_both;
    s.x0 = b->x0;
    s.x1 = b->x1;
    s.moved = b->moved;
    s.n_moved = b->moved ? b->nv : 0;
    s.r = b->r;
    s.tri = b->tree.tri;
    s.own = b->tree.own;
    s.both = (const int32_t(*)[2])b->both.data;
    b->n = b->n_vf = 0;
    if (!b->n_both)
        return DRAPE_OK;
    int status = find(g, b, &s);
    b->n = s.n_pair;
    b->n_vf = s.n_vf;
    return status;
}

/* After an allocation failed some pools have grown and others not. This frees
 * the scratch pools and the front's pairs, so that the next query begins from
 * the roots. */
static void drop(struct gpu *g, struct broad *b)
{
    struct broad_pool *pool[] = {&b->pair, &b->mask, &b->act, &b->sum};
    for (int k = 0; k < 4; k++) {
        gpu_give(g, pool[k]->data);
        *pool[k] = {};
    }
    b->n_front = 0;
}

int gpu_broad_meshes_apart(struct gpu *g, struct broad *b, const vec *x0,
                           const vec *x1, real r, bool *apart)
{
    struct extent s = {};
    s.nv = b->nv;
    s.n_grid = b->map.n_grid;
    s.grid = b->map.grid;
    s.x0 = x0;
    s.x1 = x1;
    *apart = false;
    if (!b->apart.able)
        return DRAPE_OK;
    size_t bytes = (size_t)s.n_grid * sizeof *s.bounds;
    s.bounds = (struct mesh_bounds *)gpu_scratch(g, SLOT_STAGE, s.n_grid,
                                                 sizeof *s.bounds);
    int status = s.bounds ? gpu_extent(g, &s) : gpu_status(g);
    gpu_trace(g, b->trace, "extent", s.bounds, bytes);
    gpu_down(g, b->apart.bounds, s.bounds, bytes);
    if (status == DRAPE_OK)
        status = gpu_status(g);
    *apart = status == DRAPE_OK && apart_all(&b->apart, r);
    if (*apart)
        broad_count_empty(b);
    return status;
}

int gpu_broad_query(struct gpu *g, struct broad *b, const vec *x0,
                    const vec *x1, real r, const uint8_t *moved)
{
    b->x0 = x0;
    b->x1 = x1;
    b->r = r;
    b->moved = moved ? moved : b->awake;
    b->later = moved && b->started && b->n_front > 0;
    b->dozes = !moved && b->awake;
    /* Refit is waited for at once in a first query, whose boxes do not exist
     * yet, and in a traced run, whose trace must end at bad positions. */
    bool now = !b->started || b->trace;
    bool every = makes_all(b);
    int64_t walked = b->walked, cleared = b->cleared;
    refit(g, b);
    if (now)
        gpu_read_back_keep(g, REFIT_WORDS);
    int status = now ? refitted(g, b) : (int)DRAPE_OK;
    if (status == DRAPE_OK && b->cones)
        status = cones(g, b, every);
    if (status == DRAPE_OK && !b->later)
        status = update_front(g, b);
    if (status == DRAPE_OK)
        status = walk(g, b);
    if (status == DRAPE_OK && !now)
        status = refitted(g, b);
    if (status == DRAPE_EDATA) { /* walked among boxes of another query */
        b->walked = walked;
        b->cleared = cleared;
        b->n_front = b->later ? b->n_front : 0;
    }
    if (status == DRAPE_OK)
        status = candidates(g, b);
    if (status == DRAPE_ENOMEM)
        drop(g, b);
    return status;
}
