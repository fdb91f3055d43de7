/* SPDX-License-Identifier: Apache-2.0 */
/* Runs the stages of the broad phase in order and grows their streams when a
 * capacity is exceeded. spec/broad/broad.md */
#include "ref/broad/broad.h"

#include "ref/broad/box.h"
#include "ref/broad/bvtt.h"
#include "ref/broad/cones.h"
#include "ref/broad/extent.h"
#include "ref/broad/features.h"
#include "ref/broad/front.h"
#include "ref/broad/refit.h"
#include "ref/broad/walk.h"

/* Makes sure that a pool has a capacity of `need` items, with a quarter more in
 * reserve when the pool must grow. Without memory the old pool stays. */
static int grow_pool(struct broad *b, struct broad_pool *p,
                     enum arena_part part, int64_t need, size_t size)
{
    if (need <= p->cap)
        return DRAPE_OK;
    int64_t cap = need + need / 4 + 256;
    void *data = arena_take(b->arena, part, cap, size);
    if (!data)
        return DRAPE_ENOMEM;
    arena_give(b->arena, p->data);
    p->data = data;
    p->cap = cap;
    return DRAPE_OK;
}

/* Grows the scratch streams of front and walk to `need` node pairs. b->pair,
 * the stream of the pairs themselves, is grown last. */
static int grow_scratch(struct broad *b, int64_t need)
{
    int status = grow_pool(b, &b->mask, ARENA_PAIRS, need, sizeof(uint16_t));
    if (status == DRAPE_OK)
        status = grow_pool(b, &b->act, ARENA_PAIRS, need, sizeof(uint8_t));
    if (status == DRAPE_OK)
        status = grow_pool(b, &b->sum, ARENA_PAIRS, need / BVTT_BLOCK + 1,
                           sizeof(int64_t));
    if (status == DRAPE_OK)
        status = grow_pool(b, &b->pair, ARENA_PAIRS, need, 4 * sizeof(int32_t));
    return status;
}

/* §1: whether triangles of two meshes are compared. */
static bool are_compared(const struct tree_mesh *k, const struct tree_mesh *l,
                         bool self)
{
    bool cloth = k->kind == TREE_CLOTH, other = l->kind == TREE_CLOTH;
    if (!k->tris || !l->tris)
        return false;
    if (cloth && other)
        return self;
    return k == l ? k->self && k->kind != TREE_STATIC : cloth || other;
}

static int64_t count_still(const struct tree *t)
{
    int64_t still = 0;
    for (int64_t l = 0; l < t->levels; l++) {
        const int32_t *run = t->range + TREE_STATIC * t->levels + l;
        still += run[1] - run[0];
    }
    return still;
}

static int make_roots(struct broad *b, const struct tree_scene *s, bool self)
{
    int64_t n = 0;
    int32_t *top = arena_take(b->arena, ARENA_OTHER, s->meshes, sizeof *top);
    if (!top)
        return DRAPE_ENOMEM;
    for (int32_t a = 0; a < b->tree.n; a++)
        if (b->tree.parent[a] < 0)
            top[b->tree.mesh[a]] = a;
    for (int32_t k = 0; k < s->meshes; k++)
        for (int32_t l = k; l < s->meshes; l++)
            n += are_compared(&s->mesh[k], &s->mesh[l], self);
    b->root = arena_take(b->arena, ARENA_FRONT, n, sizeof *b->root);
    if (!b->root)
        return DRAPE_ENOMEM;
    for (int32_t k = 0; k < s->meshes; k++)
        for (int32_t l = k; l < s->meshes; l++)
            if (are_compared(&s->mesh[k], &s->mesh[l], self)) {
                b->root[b->roots][0] = top[k];
                b->root[b->roots++][1] = top[l];
            }
    arena_give(b->arena, top);
    return DRAPE_OK;
}

/* Resets the front to the root pairs and gives front and scratch a capacity of
 * `need` pairs. Without memory the old capacity stays, and the reset is done
 * all the same. */
static int begin_front(struct broad *b, int64_t need)
{
    int status = grow_scratch(b, need + need / 4 + 256);
    if (status == DRAPE_OK)
        status =
            grow_pool(b, &b->front, ARENA_FRONT, need, 2 * sizeof(int32_t));
    b->n_front = b->front.data ? b->roots : 0;
    if (b->n_front)
        memcpy(b->front.data, b->root, (size_t)b->roots * sizeof *b->root);
    return status;
}

int broad_make(struct broad *b, const struct tree_scene *scene, bool self,
               struct arena *arena)
{
    memset(b, 0, sizeof *b);
    b->arena = arena;
    b->nv = scene->vertices;
    b->stop = 2;
    int status = tree_build(scene, arena, &b->tree, &b->map);
    if (status != DRAPE_OK)
        return status;
    int64_t n = b->tree.n, n_cloth = b->tree.n_cloth;
    b->cones = self && n_cloth > 0;
    b->still = count_still(&b->tree);
    b->box = arena_take(arena, ARENA_TREE, n, sizeof *b->box);
    b->stir = arena_take(arena, ARENA_TREE, n, sizeof *b->stir);
    b->clear = arena_take(arena, ARENA_TREE, n_cloth, sizeof *b->clear);
    b->n_inner = b->cones ? tree_inner(&b->tree) : 0;
    b->tangents =
        arena_take(arena, ARENA_TREE, b->n_inner, sizeof *b->tangents);
    if (arena->failed)
        return DRAPE_ENOMEM;
    status = make_roots(b, scene, self);
    if (status == DRAPE_OK)
        status = apart_make(&b->apart, scene, &b->tree, &b->map, b->roots,
                            (const int32_t(*)[2])b->root, arena);
    return status == DRAPE_OK ? begin_front(b, b->roots) : status;
}

void broad_count_empty(struct broad *b)
{
    b->queries++;
    b->kept += b->tree.n;
    b->n = b->n_vf = b->n_both = b->visited = 0;
}

int broad_meshes_apart(struct broad *b, const vec *x0, const vec *x1, real r,
                       bool *apart)
{
    struct extent s = {.nv = b->nv,
                       .n_grid = b->map.n_grid,
                       .grid = b->map.grid,
                       .x0 = x0,
                       .x1 = x1,
                       .bounds = b->apart.bounds};
    *apart = false;
    if (!b->apart.able)
        return DRAPE_OK;
    int status = ref_extent(&s);
    trace_stage(b->trace, "extent", s.bounds,
                (size_t)s.n_grid * sizeof *s.bounds);
    *apart = status == DRAPE_OK && apart_all(&b->apart, r);
    if (*apart)
        broad_count_empty(b);
    return status;
}

int broad_refit(struct broad *b, const vec *x0, const vec *x1, real r,
                const uint8_t *moved)
{
    b->later = moved && b->started && b->n_front > 0;
    b->moved = moved ? moved : b->awake;
    b->dozes = !moved && b->awake;
    struct refit fit = {.tree = b->tree,
                        .nv = b->nv,
                        .x0 = x0,
                        .x1 = x1,
                        .n_moved = b->later || b->dozes ? b->nv : 0,
                        .moved = b->moved,
                        .all = !b->started || (b->restless && !b->later),
                        .every = b->dozes && !(b->made && b->started),
                        .box = b->box,
                        .stir = b->stir};
    b->x0 = x0;
    b->x1 = x1;
    b->r = r;
    int status = ref_refit(&fit);
    b->queries++;
    int64_t made =
        status == DRAPE_OK && !b->started ? fit.made - b->still : fit.made;
    b->refitted += made;
    b->kept += b->tree.n - made;
    trace_stage(b->trace, "refit", b->box, (size_t)b->tree.n * sizeof *b->box);
    b->started = b->started || status == DRAPE_OK;
    b->made = b->made || (b->dozes && status == DRAPE_OK);
    if (status != DRAPE_OK || !b->cones)
        return status;
    if (fit.every) /* what does not stir is compared with nothing of itself */
        memset(b->clear, CLEAR_ALL, (size_t)b->tree.n_cloth);
    struct cones cones = {.tree = b->tree,
                          .map = b->map,
                          .nv = b->nv,
                          .x0 = x0,
                          .x1 = x1,
                          .r = r,
                          .stir = b->stir,
                          .n_inner = b->n_inner,
                          .clear = b->clear,
                          .tangents = b->tangents};
    status = ref_cones(&cones);
    trace_stage(b->trace, "cones", b->clear, (size_t)b->tree.n_cloth);
    return status;
}

int broad_update_front(struct broad *b)
{
    struct front s = {
        .stop = b->stop,
        .in = {.tree = b->tree, .box = b->box, .clear = b->clear, .r = b->r}};
    if (!b->n_front && begin_front(b, b->roots) != DRAPE_OK)
        return DRAPE_ENOMEM;
    for (;;) {
        s.cap = b->front.cap;
        s.n = b->n_front;
        s.pair = b->front.data;
        s.other = b->pair.data;
        s.act = b->act.data;
        s.act_other = b->mask.data;
        s.sum = b->sum.data;
        int status = ref_front(&s);
        b->n_front = s.n;
        b->front_visited = s.visited;
        if (status != DRAPE_EFULL) {
            trace_stage(b->trace, "front", b->front.data,
                        (size_t)s.n * 2 * sizeof(int32_t));
            return status;
        }
        status = begin_front(b, s.need);
        if (status != DRAPE_OK)
            return status;
    }
}

/* Runs stage walk, growing its streams until the triangle pairs below the front
 * fit. */
static int run_walk(struct broad *b)
{
    struct walk s = {
        .nv = b->nv,
        .x0 = b->x0,
        .x1 = b->x1,
        .stir = b->stir,
        .n_front = b->n_front,
        .front = b->front.data,
        .in = {.tree = b->tree, .box = b->box, .clear = b->clear, .r = b->r}};
    for (;;) {
        s.cap = b->pair.cap < b->mask.cap ? b->pair.cap : b->mask.cap;
        s.pair = b->pair.data;
        s.other = s.pair + s.cap;
        s.mask = b->mask.data;
        s.sum = b->sum.data;
        s.cap_tri = b->both.cap;
        s.tri = b->both.data;
        int status = ref_walk(&s);
        b->n_both = s.n_tri;
        b->visited = s.visited;
        if (status != DRAPE_EFULL) {
            b->walked += s.visited;
            b->cleared += s.cleared;
            trace_stage(b->trace, "walk", s.tri,
                        (size_t)s.n_tri * 2 * sizeof(int32_t));
            return status;
        }
        status = grow_scratch(b, s.need);
        if (status == DRAPE_OK)
            status = grow_pool(b, &b->both, ARENA_PAIRS, s.need_tri,
                               2 * sizeof(int32_t));
        if (status != DRAPE_OK)
            return status;
    }
}

int broad_candidates(struct broad *b)
{
    int status = run_walk(b);
    struct features s = {.nv = b->nv,
                         .nt = b->tree.n_tri,
                         .n = b->n_both,
                         .x0 = b->x0,
                         .x1 = b->x1,
                         .moved = b->moved,
                         .n_moved = b->moved ? b->nv : 0,
                         .r = b->r,
                         .tri = b->tree.tri,
                         .own = b->tree.own,
                         .both = b->both.data};
    b->n = b->n_vf = 0;
    if (status != DRAPE_OK || !b->n_both)
        return status;
    status = grow_pool(b, &b->mask, ARENA_PAIRS, s.n, sizeof *s.mask);
    if (status == DRAPE_OK)
        status = grow_pool(b, &b->sum, ARENA_PAIRS, 2 * bvtt_blocks(s.n),
                           sizeof *s.sum);
    while (status == DRAPE_OK) {
        s.mask = b->mask.data;
        s.sum = b->sum.data;
        s.cap = b->pair.cap < b->kind.cap ? b->pair.cap : b->kind.cap;
        s.pair = b->pair.data;
        s.kind = b->kind.data;
        status = ref_features(&s);
        if (status != DRAPE_EFULL)
            break;
        status =
            grow_pool(b, &b->pair, ARENA_PAIRS, s.need, 4 * sizeof(int32_t));
        if (status == DRAPE_OK)
            status = grow_pool(b, &b->kind, ARENA_PAIRS, s.need, 1);
    }
    trace_stage(b->trace, "features", s.pair,
                (size_t)s.n_pair * 4 * sizeof(int32_t));
    b->n = s.n_pair;
    b->n_vf = s.n_vf;
    return status;
}

int broad_query(struct broad *b, const vec *x0, const vec *x1, real r,
                const uint8_t *moved)
{
    int status = broad_refit(b, x0, x1, r, moved);
    if (status == DRAPE_OK && !b->later)
        status = broad_update_front(b);
    if (status == DRAPE_OK)
        status = broad_candidates(b);
    if (status == DRAPE_EDATA && !b->later)
        b->n_front = 0; /* a device may have moved it */
    return status;
}
