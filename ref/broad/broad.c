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

static int grow_pool(struct broad *b, struct pool *p, int64_t need, size_t size)
{
    bool front = p == &b->front;
    if (need <= p->cap)
        return DRAPE_OK;
    return b->run->grow(b->on, p, front ? ARENA_FRONT : ARENA_PAIRS, need, size,
                        front);
}

/* Grows the scratch streams of front and walk to `need` node pairs. */
static int grow_scratch(struct broad *b, int64_t need)
{
    int status = grow_pool(b, &b->mask, need, sizeof(uint16_t));
    if (status == DRAPE_OK)
        status = grow_pool(b, &b->act, need, sizeof(uint8_t));
    if (status == DRAPE_OK)
        status = grow_pool(b, &b->sum, need / BVTT_BLOCK + 1, sizeof(int64_t));
    if (status == DRAPE_OK)
        status = grow_pool(b, &b->pair, need, 4 * sizeof(int32_t));
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

static int make_roots(struct broad *b, const struct tree_scene *s, bool self,
                      struct arena *arena)
{
    int64_t n = 0;
    int32_t *top = arena_take(arena, ARENA_OTHER, s->meshes, sizeof *top);
    if (!top)
        return DRAPE_ENOMEM;
    for (int32_t a = 0; a < b->tree.n; a++)
        if (b->tree.parent[a] < 0)
            top[b->tree.mesh[a]] = a;
    for (int32_t k = 0; k < s->meshes; k++)
        for (int32_t l = k; l < s->meshes; l++)
            n += are_compared(&s->mesh[k], &s->mesh[l], self);
    b->root = arena_take(arena, ARENA_FRONT, n, sizeof *b->root);
    if (!b->root)
        return DRAPE_ENOMEM;
    for (int32_t k = 0; k < s->meshes; k++)
        for (int32_t l = k; l < s->meshes; l++)
            if (are_compared(&s->mesh[k], &s->mesh[l], self)) {
                b->root[b->roots][0] = top[k];
                b->root[b->roots++][1] = top[l];
            }
    arena_give(arena, top);
    return DRAPE_OK;
}

int broad_begin_front(struct broad *b, int64_t need)
{
    int status = grow_pool(b, &b->front, need, 2 * sizeof(int32_t));
    if (status == DRAPE_OK)
        status = grow_scratch(b, b->front.cap);
    if (status != DRAPE_OK)
        return status;
    b->n_front = b->roots;
    b->run->copy(b->on, b->front.data, b->root,
                 (size_t)b->roots * sizeof *b->root);
    return DRAPE_OK;
}

int broad_make(struct broad *b, const struct tree_scene *scene, bool self,
               struct arena *arena)
{
    memset(b, 0, sizeof *b);
    b->run = &backend_ref;
    b->on = backend_of(arena);
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
    status = make_roots(b, scene, self, arena);
    if (status == DRAPE_OK)
        status = apart_make(&b->apart, scene, &b->tree, &b->map, b->roots,
                            (const int32_t(*)[2])b->root, arena);
    return status == DRAPE_OK ? broad_begin_front(b, b->roots) : status;
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
    int status = b->run->extent(b->on, &s);
    trace_stage(b->trace, "extent", s.bounds,
                (size_t)s.n_grid * sizeof *s.bounds);
    *apart = status == DRAPE_OK && apart_all(&b->apart, r);
    if (*apart)
        broad_count_empty(b);
    return status;
}

static struct refit refit_of(const struct broad *b)
{
    return (struct refit){.tree = b->tree,
                          .nv = b->nv,
                          .x0 = b->x0,
                          .x1 = b->x1,
                          .n_moved = b->later || b->dozes ? b->nv : 0,
                          .moved = b->moved,
                          .all = !b->started || (b->restless && !b->later),
                          .every = b->dozes && !(b->made && b->started),
                          .box = b->box,
                          .stir = b->stir};
}

/* Counts a stage refit that has ended with this status. */
static void count_refit(struct broad *b, const struct refit *s, int status)
{
    bool good = status == DRAPE_OK;
    int64_t made = good ? s->made - (b->started ? 0 : b->still) : 0;
    b->queries++;
    b->refitted += made;
    b->kept += b->tree.n - made;
    b->started = b->started || good;
    b->made = b->made || (b->dozes && good);
}

/* every: the boxes of all nodes were made. */
static int run_cones(struct broad *b, bool every)
{
    struct cones s = {.tree = b->tree,
                      .map = b->map,
                      .nv = b->nv,
                      .x0 = b->x0,
                      .x1 = b->x1,
                      .r = b->r,
                      .stir = b->stir,
                      .n_inner = b->n_inner,
                      .clear = b->clear,
                      .tangents = b->tangents};
    if (every) /* what does not stir is compared with nothing of itself */
        b->run->broad_all_clear(b->on, b->tree.n_cloth, b->clear);
    int status = b->run->cones(b->on, &s);
    b->run->trace(b->on, b->trace, "cones", b->clear, (size_t)b->tree.n_cloth);
    return status;
}

/* Moves the front to where the refitted boxes put it. */
static int update_front(struct broad *b)
{
    struct front s = {
        .stop = b->stop,
        .in = {.tree = b->tree, .box = b->box, .clear = b->clear, .r = b->r}};
    int status = b->n_front ? DRAPE_OK : broad_begin_front(b, b->roots);
    while (status == DRAPE_OK) {
        s.cap = b->front.cap;
        s.n = b->n_front;
        s.pair = b->front.data;
        s.other = b->pair.data;
        s.act = b->act.data;
        s.act_other = b->mask.data;
        s.sum = b->sum.data;
        status = b->run->front(b->on, &s);
        b->n_front = s.n;
        b->front_visited = s.visited;
        if (status != DRAPE_EFULL) {
            b->run->trace(b->on, b->trace, "front", b->front.data,
                          (size_t)s.n * 2 * sizeof(int32_t));
            break;
        }
        status = broad_begin_front(b, s.need);
    }
    return status;
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
        s.other = s.cap > 0 ? s.pair + s.cap : s.pair;
        s.mask = b->mask.data;
        s.sum = b->sum.data;
        s.cap_tri = b->both.cap;
        s.tri = b->both.data;
        int status = b->run->walk(b->on, &s);
        b->n_both = s.n_tri;
        b->visited = s.visited;
        if (status != DRAPE_EFULL) {
            b->walked += s.visited;
            b->cleared += s.cleared;
            b->run->trace(b->on, b->trace, "walk", s.tri,
                          (size_t)s.n_tri * 2 * sizeof(int32_t));
            return status;
        }
        status = grow_scratch(b, s.need);
        if (status == DRAPE_OK)
            status = grow_pool(b, &b->both, s.need_tri, 2 * sizeof(int32_t));
        if (status != DRAPE_OK)
            return status;
    }
}

/* Runs stage features, growing its streams until the candidates fit. */
static int find_candidates(struct broad *b)
{
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
                         .n_start = b->n_start,
                         .n_sewn = b->n_sewn,
                         .start = b->start,
                         .sewn = b->sewn,
                         .both = b->both.data};
    if (!b->n_both)
        return DRAPE_OK;
    int status = grow_pool(b, &b->mask, s.n, sizeof *s.mask);
    if (status == DRAPE_OK)
        status = grow_pool(b, &b->sum, 2 * bvtt_blocks(s.n), sizeof *s.sum);
    while (status == DRAPE_OK) {
        s.mask = b->mask.data;
        s.sum = b->sum.data;
        s.cap = b->pair.cap < b->kind.cap ? b->pair.cap : b->kind.cap;
        s.pair = b->pair.data;
        s.kind = b->kind.data;
        status = b->run->features(b->on, &s);
        if (status != DRAPE_EFULL)
            break;
        status = grow_pool(b, &b->pair, s.need, 4 * sizeof(int32_t));
        if (status == DRAPE_OK)
            status = grow_pool(b, &b->kind, s.need, 1);
    }
    b->run->trace(b->on, b->trace, "features", s.pair,
                  (size_t)s.n_pair * 4 * sizeof(int32_t));
    b->n = s.n_pair;
    b->n_vf = s.n_vf;
    return status;
}

/* After a lack of memory some pools have grown and others not. This gives back
 * the scratch and forgets the front, so that the next query begins from the
 * roots. */
static void drop_scratch(struct broad *b)
{
    struct pool *pool[] = {&b->pair, &b->mask, &b->act, &b->sum};
    for (int k = 0; k < 4; k++) {
        b->run->give(b->on, pool[k]->data);
        *pool[k] = (struct pool){0};
    }
    b->n_front = 0;
}

int broad_query(struct broad *b, const vec *x0, const vec *x1, real r,
                const uint8_t *moved)
{
    b->x0 = x0;
    b->x1 = x1;
    b->r = r;
    b->moved = moved ? moved : b->awake;
    b->later = moved && b->started && b->n_front > 0;
    b->dozes = !moved && b->awake;
    b->n = b->n_vf = 0;
    /* A device is asked about refit at once in a first query, whose boxes do
     * not exist yet, and in a traced run, whose trace must end at bad
     * positions. */
    bool now = !b->started || b->trace;
    int64_t walked = b->walked, cleared = b->cleared;
    struct refit fit = refit_of(b);
    int status = b->run->refit(b->on, &fit);
    b->run->trace(b->on, b->trace, "refit", b->box,
                  (size_t)b->tree.n * sizeof *b->box);
    if (status == DRAPE_OK && now)
        status = b->run->broad_refitted(b->on, &fit, true);
    if (status != DRAPE_OK || now)
        count_refit(b, &fit, status);
    if (status == DRAPE_OK && b->cones)
        status = run_cones(b, fit.every);
    if (status == DRAPE_OK && !b->later)
        status = update_front(b);
    if (status == DRAPE_OK)
        status = run_walk(b);
    if (status == DRAPE_OK && !now) {
        status = b->run->broad_refitted(b->on, &fit, false);
        count_refit(b, &fit, status);
    }
    if (status == DRAPE_EDATA) { /* walked among boxes of another query */
        b->walked = walked;
        b->cleared = cleared;
        b->n_front = b->later ? b->n_front : 0;
    }
    if (status == DRAPE_OK)
        status = find_candidates(b);
    if (status == DRAPE_ENOMEM)
        drop_scratch(b);
    return status;
}

/* The reference knows how refit ended when the stage returns. */
int ref_broad_refitted(struct gpu *on, struct refit *s, bool now)
{
    (void)on;
    (void)s;
    (void)now;
    return DRAPE_OK;
}

void ref_broad_all_clear(struct gpu *on, int64_t n, uint8_t *clear)
{
    (void)on;
    memset(clear, CLEAR_ALL, (size_t)n);
}
