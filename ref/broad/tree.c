/* SPDX-License-Identifier: Apache-2.0 */
/* Builds the BVH of every mesh at rest. spec/broad/tree.md */
#include "ref/broad/tree_plan.h"

static int mesh_levels(const struct tree_mesh *g)
{
    if (g->kind == TREE_CLOTH)
        return tree_grid_levels(g);
    int l = 1;
    for (int64_t nodes = (g->tris + 3) / 4; nodes > 1; nodes = (nodes + 3) / 4)
        l++;
    return l;
}

/* Checks the meshes and finds an upper bound of the number of nodes. */
static int measure_meshes(struct tree_plan *p)
{
    const struct tree_scene *s = p->scene;
    int32_t at_tri = 0;
    for (int32_t k = 0; k < s->meshes; k++) {
        const struct tree_mesh *g = &s->mesh[k];
        bool grid = g->kind == TREE_CLOTH;
        if (g->first_tri != at_tri || g->tris < 0 || (grid && p->grids != k) ||
            (grid && (g->m < 2 || g->n < 2 || g->m > 32768 || g->n > 32768)))
            return DRAPE_EARG;
        at_tri += g->tris;
        p->grids += grid;
        int levels = mesh_levels(g);
        if (p->tree->levels < levels)
            p->tree->levels = levels;
        for (int l = 0; l < levels && grid; l++)
            p->n_at += (int64_t)tree_side(g->m - 1, l) * tree_side(g->n - 1, l);
        int64_t nodes = g->tris;
        for (int l = 0; l < levels && !grid && g->tris; l++)
            p->n_most += nodes = (nodes + 3) / 4;
    }
    p->n_most += p->n_at;
    return at_tri == s->tris && s->meshes <= UINT16_MAX &&
                   p->n_most <= INT32_MAX
               ? DRAPE_OK
               : DRAPE_EARG;
}

struct item {
    real c[3]; /* three times the centroid */
    int32_t tri;
};

static bool comes_before(const struct item *a, const struct item *b, int axis)
{
    return a->c[axis] < b->c[axis] ||
           (a->c[axis] == b->c[axis] && a->tri < b->tri);
}

/* Moves the k smallest items along an axis to the front (Hoare's selection). */
static void select_first(struct item *a, int64_t n, int64_t k, int axis)
{
    int64_t lo = 0, hi = n - 1;
    while (lo < hi) {
        struct item pivot = a[lo + (hi - lo) / 2];
        int64_t i = lo, j = hi;
        while (i <= j) {
            while (comes_before(&a[i], &pivot, axis))
                i++;
            while (comes_before(&pivot, &a[j], axis))
                j--;
            if (i <= j) {
                struct item swap = a[i];
                a[i++] = a[j];
                a[j--] = swap;
            }
        }
        if (k <= j)
            hi = j;
        else if (k >= i)
            lo = i;
        else
            return;
    }
}

/* §3: orders items so that every aligned run of 4^k items is compact. Each
 * split is across the longest side of the centroids' box, and its left part is
 * a full run. */
static void split_items(struct item *a, int64_t n, int64_t capacity)
{
    while (n > 4) {
        capacity /= 2;
        if (n <= capacity)
            continue;
        int axis = 0;
        real longest = -1;
        for (int d = 0; d < 3; d++) {
            real lo = a[0].c[d], hi = a[0].c[d];
            for (int64_t k = 1; k < n; k++) {
                lo = real_min(lo, a[k].c[d]);
                hi = real_max(hi, a[k].c[d]);
            }
            axis = hi - lo > longest ? d : axis;
            longest = real_max(longest, hi - lo);
        }
        select_first(a, n, capacity, axis);
        split_items(a, capacity, capacity);
        a += capacity;
        n -= capacity;
    }
}

static void sort_mesh(struct tree_plan *p, const struct tree_mesh *g,
                      struct item *item)
{
    for (int32_t k = 0; k < g->tris; k++) {
        const int32_t *f = p->scene->tri[g->first_tri + k];
        const vec *x = p->scene->x;
        vec c = vec_add(vec_add(x[f[0]], x[f[1]]), x[f[2]]);
        struct item made = {{c.x, c.y, c.z}, g->first_tri + k};
        item[k] = made;
    }
    int64_t capacity = 4;
    while (capacity < g->tris)
        capacity *= 4;
    split_items(item, g->tris, capacity);
    for (int32_t k = 0; k < g->tris; k++)
        p->order[g->first_tri + k] = item[k].tri;
}

/* Fills the nodes of a mesh without a grid: each four nodes of a level get one
 * parent. */
static void fill_mesh(struct tree_plan *p, int32_t k,
                      const struct tree_run *run)
{
    const struct tree_mesh *g = &p->scene->mesh[k];
    int levels = mesh_levels(g);
    int32_t below = g->tris;
    for (int l = 0; l < levels && g->tris; l++) {
        int32_t nodes = (below + 3) / 4;
        for (int32_t i = 0; i < nodes; i++) {
            int32_t a = run->first[l] + i;
            p->mesh[a] = (uint16_t)k;
            p->level[a] = (uint8_t)l;
            p->first[a] = 4 * i + (l ? run->first[l - 1] : g->first_tri);
            p->count[a] = (uint8_t)(below - 4 * i < 4 ? below - 4 * i : 4);
            p->parent[a] = l + 1 < levels ? run->first[l + 1] + i / 4 : -1;
        }
        below = nodes;
    }
}

enum { SIZE_OF_ONE = 100 };
int tree_size(const struct tree_scene *s, const struct tree_mesh *g)
{
    vec lo = {0}, hi = {0};
    for (int32_t t = g->first_tri; t < g->first_tri + g->tris; t++)
        for (int k = 0; k < 3; k++) {
            vec x = s->x[s->tri[t][k]];
            bool start = t == g->first_tri && k == 0;
            lo = start ? x : vec_min(lo, x);
            hi = start ? x : vec_max(hi, x);
        }
    real longest = real_max(real_max(hi.x - lo.x, hi.y - lo.y), hi.z - lo.z);
    int e = 0;
    for (; longest >= 2; e++)
        longest /= 2;
    for (; longest < 1 && e > -60; e--)
        longest *= 2;
    return SIZE_OF_ONE + e;
}

/* §1: gives each run of nodes its place in the stream, class by class, then
 * level by level, then mesh by mesh. */
static void number_nodes(struct tree_plan *p, struct tree_run *run)
{
    int64_t levels = p->tree->levels;
    int32_t next = 0;
    for (int c = 0; c < TREE_CLASSES; c++)
        for (int64_t l = 0; l < levels; l++) {
            p->range[c * levels + l] = next;
            for (int32_t k = 0; k < p->scene->meshes; k++) {
                if (p->scene->mesh[k].kind != c)
                    continue;
                run[k].first[l] = next;
                next += run[k].nodes[l];
            }
        }
    p->range[TREE_CLASSES * levels] = next;
    p->tree->n = next;
    p->tree->n_cloth = p->range[levels];
}

static int fill_tree(struct tree_plan *p, struct item *item,
                     struct tree_run *run)
{
    const struct tree_scene *s = p->scene;
    memset(run, 0, (size_t)s->meshes * sizeof *run);
    p->n_at = 0;
    for (int32_t k = 0; k < s->meshes; k++) {
        const struct tree_mesh *g = &s->mesh[k];
        if (g->kind == TREE_CLOTH) {
            if (tree_grid_mark(p, k, &run[k]) != DRAPE_OK)
                return DRAPE_EARG;
            continue;
        }
        int32_t below = g->tris;
        for (int l = 0; l < mesh_levels(g); l++)
            run[k].nodes[l] = below = (below + 3) / 4;
        sort_mesh(p, g, item);
    }
    number_nodes(p, run);
    for (int32_t k = 0; k < s->meshes; k++) {
        const struct tree_mesh *g = &s->mesh[k];
        int size = g->size ? g->size : tree_size(s, g);
        int low = size - mesh_levels(g);
        if (g->kind == TREE_CLOTH)
            tree_grid_fill(p, k, &run[k]);
        else
            fill_mesh(p, k, &run[k]);
        for (int l = 0; l < mesh_levels(g); l++)
            for (int32_t i = 0; i < run[k].nodes[l]; i++)
                p->rank[run[k].first[l] + i] = (uint8_t)(low + l);
    }
    return DRAPE_OK;
}

/* Takes the streams from the arena. */
static void take_streams(struct tree_plan *p, struct arena *a)
{
    int64_t n = p->n_most, tris = p->scene->tris;
    p->first = arena_take(a, ARENA_TREE, n, sizeof *p->first);
    p->parent = arena_take(a, ARENA_TREE, n, sizeof *p->parent);
    p->count = arena_take(a, ARENA_TREE, n, sizeof *p->count);
    p->level = arena_take(a, ARENA_TREE, n, sizeof *p->level);
    p->rank = arena_take(a, ARENA_TREE, n, sizeof *p->rank);
    p->mesh = arena_take(a, ARENA_TREE, n, sizeof *p->mesh);
    p->order = arena_take(a, ARENA_TREE, tris, sizeof *p->order);
    p->own = arena_take(a, ARENA_TREE, tris, sizeof *p->own);
    p->place = arena_take(a, ARENA_TREE, p->n_at, sizeof *p->place);
    p->full = arena_take(a, ARENA_TREE, p->n_at, sizeof *p->full);
    p->at = arena_take(a, ARENA_TREE, p->n_at, sizeof *p->at);
    p->grid = arena_take(a, ARENA_TREE, p->grids, sizeof *p->grid);
    p->range = arena_take(a, ARENA_TREE, TREE_CLASSES * p->tree->levels + 1,
                          sizeof *p->range);
}

static void publish_map(const struct tree_plan *p, struct tree_map *map)
{
    struct tree *t = p->tree;
    t->n_tri = p->scene->tris;
    t->n_range = TREE_CLASSES * t->levels + 1;
    t->first = p->first;
    t->parent = p->parent;
    t->count = p->count;
    t->level = p->level;
    t->rank = p->rank;
    t->mesh = p->mesh;
    t->order = p->order;
    t->tri = p->scene->tri;
    t->own = p->own;
    t->place = p->place;
    t->range = p->range;
    map->n_grid = p->grids;
    map->n_at = p->n_at;
    map->grid = p->grid;
    map->at = p->at;
    map->full = p->full;
}

int tree_build(const struct tree_scene *scene, struct arena *arena,
               struct tree *tree, struct tree_map *map)
{
    struct tree_plan p = {.scene = scene, .tree = tree};
    memset(tree, 0, sizeof *tree);
    memset(map, 0, sizeof *map);
    int status = measure_meshes(&p);
    if (status != DRAPE_OK)
        return status;
    take_streams(&p, arena);
    struct item *item =
        arena_take(arena, ARENA_TREE, scene->tris, sizeof *item);
    struct tree_run *run =
        arena_take(arena, ARENA_TREE, scene->meshes, sizeof *run);
    status = arena->failed ? DRAPE_ENOMEM : fill_tree(&p, item, run);
    if (status == DRAPE_OK)
        status = tree_own(scene, arena, p.own);
    if (status == DRAPE_OK)
        status = tree_one_rings(scene, arena, &tree->one_rings);
    arena_give(arena, item);
    arena_give(arena, run);
    publish_map(&p, map);
    return status;
}
