/* SPDX-License-Identifier: Apache-2.0 */
/* Builds small scenes for tests of the broad phase, and finds their candidates
 * by brute force. See tests/broad/fabric.h. */
#include "tests/broad/fabric.h"

#include "ref/broad/cones.h"
#include "ref/broad/refit.h"

#include <stdlib.h>

static void make_in(struct fabric *f, int32_t vertices, int32_t tris,
                    uint64_t seed, const drape_allocator *allocator)
{
    memset(f, 0, sizeof *f);
    arena_init(&f->arena, allocator);
    f->tri = arena_take(&f->arena, ARENA_OTHER, tris, sizeof *f->tri);
    f->x0 = arena_take(&f->arena, ARENA_OTHER, vertices, sizeof *f->x0);
    f->x1 = arena_take(&f->arena, ARENA_OTHER, vertices, sizeof *f->x1);
    f->cap_v = vertices;
    f->cap_t = tris;
    f->seed = seed * 2 + 1;
    f->scene.mesh = f->mesh;
    f->scene.tri = (const int32_t(*)[3])f->tri;
    f->scene.x = f->x0;
    if (f->arena.failed)
        abort();
}

void fabric_make(struct fabric *f, int32_t vertices, int32_t tris,
                 uint64_t seed)
{
    drape_allocator allocator = {0};
    make_in(f, vertices, tris, seed, &allocator);
}

void fabric_free(struct fabric *f)
{
    arena_free(&f->arena);
}

real fabric_random(struct fabric *f)
{
    f->seed = f->seed * UINT64_C(6364136223846793005) + 1442695040888963407u;
    return (real)((double)(f->seed >> 33) / 1073741824.0 - 1);
}

static struct tree_mesh *add_mesh(struct fabric *f, int kind)
{
    struct tree_mesh *g = &f->mesh[f->scene.meshes++];
    g->kind = kind;
    g->base = f->scene.vertices;
    g->first_tri = f->scene.tris;
    g->tris = 0;
    g->size = 0;
    return g;
}

static void add_vertex(struct fabric *f, real x, real y, real z)
{
    if (f->scene.vertices >= f->cap_v)
        abort();
    f->x0[f->scene.vertices++] = vec_make(x, y, z);
}

static void add_triangle(struct fabric *f, int32_t a, int32_t b, int32_t c)
{
    if (f->scene.tris >= f->cap_t)
        abort();
    f->tri[f->scene.tris][0] = a;
    f->tri[f->scene.tris][1] = b;
    f->tri[f->scene.tris++][2] = c;
    f->mesh[f->scene.meshes - 1].tris++;
}

/* Returns the position of (u, v) in the unit square, in a given shape. */
static vec place(struct fabric *f, enum fabric_shape shape, real u, real v,
                 real cell)
{
    double a;
    vec p;
    switch (shape) {
    case FABRIC_WAVY:
        return vec_make(u, R(0.03) * (real)sin(20 * (double)u), v);
    case FABRIC_ROLLED:
        a = 25 * (double)u;
        p = vec_make((real)cos(a), (real)sin(a), 0);
        p = vec_scale(R(0.02) + R(0.04) * u, p);
        return vec_make(p.x, p.y, v);
    case FABRIC_FOLDED:
        p.x = u < R(0.3) ? u : u < R(0.6) ? R(0.6) - u : u - R(0.6);
        p.y = u < R(0.3) ? 0 : u < R(0.6) ? R(0.002) : R(0.004);
        return vec_make(p.x, p.y, v);
    case FABRIC_CRUMPLED:
        p.x = u + cell * fabric_random(f);
        p.y = cell * fabric_random(f);
        return vec_make(p.x, p.y, v + cell * fabric_random(f));
    default:
        return vec_make(u, 0, v);
    }
}

void fabric_cloth(struct fabric *f, int32_t m, int32_t n,
                  enum fabric_shape shape, int holes)
{
    struct tree_mesh *g = add_mesh(f, TREE_CLOTH);
    real side = (real)((m > n ? m : n) - 1);
    real height = R(0.01) * (real)f->scene.meshes;
    g->m = m;
    g->n = n;
    for (int32_t j = 0; j < n; j++)
        for (int32_t i = 0; i < m; i++) {
            vec p = place(f, shape, (real)i / side, (real)j / side, 1 / side);
            add_vertex(f, p.x, p.y + height, p.z);
        }
    for (int32_t j = 0; j + 1 < n; j++)
        for (int32_t i = 0; i + 1 < m; i++) {
            int32_t v = g->base + i + m * j;
            real chance = R(0.5) * (fabric_random(f) + 1) * (real)holes;
            int gone = holes ? (int)(3 * chance) : 3;
            /* 0: the cell is missing; 1 or 2: one of its triangles is
             * missing */
            if (gone != 0 && gone != 1)
                add_triangle(f, v, v + 1, v + m);
            if (gone != 0 && gone != 2)
                add_triangle(f, v + 1, v + m + 1, v + m);
        }
}

void fabric_sphere(struct fabric *f, int kind, int32_t k, vec centre,
                   real radius)
{
    struct tree_mesh *g = add_mesh(f, kind);
    double pi = 3.14159265358979323846;
    int32_t around = 2 * k;
    add_vertex(f, centre.x, centre.y + radius, centre.z);
    for (int32_t j = 1; j < k; j++)
        for (int32_t i = 0; i < around; i++) {
            double a = pi * j / k, b = 2 * pi * i / around;
            add_vertex(f, centre.x + radius * (real)(sin(a) * cos(b)),
                       centre.y + radius * (real)cos(a),
                       centre.z + radius * (real)(sin(a) * sin(b)));
        }
    add_vertex(f, centre.x, centre.y - radius, centre.z);
    int32_t last = f->scene.vertices - 1;
    for (int32_t i = 0; i < around; i++) {
        int32_t next = (i + 1) % around, a = g->base + 1;
        add_triangle(f, g->base, a + next, a + i);
        for (int32_t j = 1; j + 1 < k; j++, a += around) {
            add_triangle(f, a + i, a + next, a + around + i);
            add_triangle(f, a + next, a + around + next, a + around + i);
        }
        add_triangle(f, a + i, a + next, last);
    }
}

void fabric_soup(struct fabric *f, int kind, int32_t tris, real size)
{
    struct tree_mesh *g = add_mesh(f, kind);
    int32_t vertices = tris / 2 + 3;
    for (int32_t k = 0; k < vertices; k++) {
        real x = fabric_random(f), y = fabric_random(f);
        add_vertex(f, size * x, size * y, size * fabric_random(f));
    }
    for (int32_t k = 0; k < tris; k++) {
        int32_t v[3];
        for (int c = 0; c < 3; c++)
            v[c] =
                (int32_t)((fabric_random(f) + 1) * R(0.499) * (real)vertices);
        add_triangle(f, g->base + v[0], g->base + v[1], g->base + v[2]);
    }
}

void fabric_scene(struct fabric *f, int k)
{
    fabric_make(f, 4000, 8000, (uint64_t)k);
    enum fabric_shape shape = (enum fabric_shape)(k % FABRIC_SHAPES);
    int holes = k % 3 == 1 ? 1 + 2 * (k % 2) : 0;
    if (k != 7)
        fabric_cloth(f, 9 + k % 7, 8 + k % 11, shape, holes);
    if (k % 4 == 1)
        fabric_cloth(f, 2 + k % 9, 2, FABRIC_FLAT, 0);
    if (k % 4 == 2)
        fabric_cloth(f, 17, 16, FABRIC_WAVY, 4);
    if (k % 2)
        fabric_sphere(f, TREE_MOVING, 3 + k % 5, vec_make(R(0.5), R(0.1), 0),
                      R(0.3));
    if (k % 5 == 0) {
        fabric_soup(f, TREE_MOVING, 1 + 7 * k % 100, R(0.4));
        f->mesh[f->scene.meshes - 1].self = k % 2;
    }
    if (k % 3 != 2)
        fabric_sphere(f, TREE_STATIC, 4, vec_make(R(0.4), 0, R(0.5)), R(0.2));
}

void fabric_move(struct fabric *f, vec common, real noise)
{
    for (int32_t k = 0; k < f->scene.vertices; k++) {
        real x = fabric_random(f), y = fabric_random(f);
        vec d = vec_make(x, y, fabric_random(f));
        f->x1[k] = vec_axpy(vec_add(f->x0[k], common), noise, d);
    }
}

static void *take_bytes(void *user, size_t bytes)
{
    return take(user, (int64_t)bytes, 1);
}

static void give_bytes(void *user, void *p, size_t bytes)
{
    (void)user, (void)p, (void)bytes;
}

/* Chooses meshes with about `size` triangles in all. */
static void choose_meshes(struct bytes *b, struct fabric *f, int32_t size)
{
    enum fabric_shape shape = (enum fabric_shape)pick(b, FABRIC_SHAPES);
    int32_t m = 2;
    while (m * m < size / 4)
        m++;
    int32_t n = 2 + (int32_t)pick(b, (uint32_t)m);
    int holes = (int)pick(b, 2);
    if (size > 0)
        fabric_cloth(f, m, n, shape, holes);
    if (pick(b, 2))
        fabric_cloth(f, 2, 3, FABRIC_FLAT, 0);
    if (size > 3 && pick(b, 2)) {
        fabric_soup(f, TREE_MOVING, size / 4, R(0.3));
        f->mesh[f->scene.meshes - 1].self = pick(b, 2);
    }
    if (size > 60 && pick(b, 4))
        fabric_sphere(f, TREE_STATIC, 4, vec_make(R(0.5), 0, R(0.2)), R(0.3));
}

void fabric_choose(struct bytes *b, struct fabric *f, struct tree *tree,
                   struct tree_map *map)
{
    drape_allocator allocator = {take_bytes, give_bytes, b};
    int32_t size = for_bench(b) ? 1000 : (int32_t)pick_size(b);
    make_in(f, 40000, 80000, pick(b, UINT32_MAX), &allocator);
    if (for_bench(b)) {
        fabric_cloth(f, 101, 101, FABRIC_WAVY, 0);
        fabric_sphere(f, TREE_STATIC, 71, vec_make(R(0.5), R(-0.38), R(0.5)),
                      R(0.4));
    } else
        choose_meshes(b, f, size);
    fabric_move(f, vec_make(0, R(-0.01), 0), pick(b, 2) ? R(0.004) : 0);
    bool wild = !for_bench(b) && pick(b, 3) == 0;
    for (int32_t v = 0; v < f->scene.vertices && wild; v++) {
        f->x0[v] = pick_vec(b, 1);
        f->x1[v] = pick(b, 3) ? pick_vec(b, 1) : f->x0[v];
    }
    if (tree_build(&f->scene, &f->arena, tree, map) != DRAPE_OK)
        abort();
}

struct box *fabric_boxes(struct bytes *b, const struct fabric *f,
                         const struct tree *tree, uint8_t *stir)
{
    struct refit s = {.tree = *tree,
                      .nv = f->scene.vertices,
                      .x0 = f->x0,
                      .x1 = f->x1,
                      .all = 1,
                      .stir = stir};
    s.box = take(b, tree->n, sizeof *s.box);
    if (ref_refit(&s) != DRAPE_OK)
        abort();
    return s.box;
}

/* Makes the root pairs: every two meshes of which one is cloth, and a mesh of
 * another class with itself where its `self` is set. */
static void choose_roots(struct bytes *b, struct fabric_walk *w)
{
    const struct tree *t = &w->in.tree;
    w->root = take(b, FABRIC_MESHES * FABRIC_MESHES, sizeof *w->root);
    for (int32_t a = 0; a < t->n; a++)
        for (int32_t c = a; c < t->n; c++) {
            bool soft = a < t->n_cloth || c < t->n_cloth;
            if (t->parent[a] >= 0)
                break;
            if (t->parent[c] >= 0 ||
                !(soft || (a == c && w->f.mesh[t->mesh[a]].self)))
                continue;
            w->root[w->roots][0] = a;
            w->root[w->roots++][1] = c;
        }
}

void fabric_walk(struct bytes *b, struct fabric_walk *w)
{
    struct tree_map map;
    memset(w, 0, sizeof *w);
    fabric_choose(b, &w->f, &w->in.tree, &map);
    const struct tree *t = &w->in.tree;
    w->stir = take(b, t->n, 1);
    w->in.box = fabric_boxes(b, &w->f, t, w->stir);
    w->in.r = pick(b, 2) ? 0 : R(0.01);
    struct cones s = {.tree = *t,
                      .map = map,
                      .nv = w->f.scene.vertices,
                      .x0 = w->f.x0,
                      .x1 = w->f.x1,
                      .r = w->in.r,
                      .stir = w->stir,
                      .n_inner = tree_inner(t)};
    s.tangents = take(b, s.n_inner, sizeof *s.tangents);
    s.clear = take(b, t->n_cloth, 1);
    if (pick(b, 3) && ref_cones(&s) != DRAPE_OK)
        abort();
    w->in.clear = s.clear;
    choose_roots(b, w);
}

struct brute {
    struct fabric *f;
    bool self;
    real reach;
    int32_t *edge, *of_edge, *of_vertex; /* edge: [2 n_edge]; mesh or -1 */
    struct box *vertex, *side;           /* boxes of vertices and edges */
    int64_t n_edge, n, cap;
    struct fabric_pair *found;
};

int fabric_compare(const void *a, const void *b)
{
    const struct fabric_pair *p = a, *q = b;
    if (p->kind != q->kind)
        return p->kind - q->kind;
    for (int k = 0; k < 4; k++)
        if (p->v[k] != q->v[k])
            return p->v[k] < q->v[k] ? -1 : 1;
    return 0;
}

static bool compared(const struct brute *u, int32_t k, int32_t l)
{
    const struct tree_mesh *a = &u->f->mesh[k], *b = &u->f->mesh[l];
    int cloths = (a->kind == TREE_CLOTH) + (b->kind == TREE_CLOTH);
    return cloths == 2 ? u->self : cloths == 1 || (k == l && a->self);
}

static void add(struct brute *u, struct fabric_pair p)
{
    if (u->n == u->cap) {
        struct fabric_pair *more =
            arena_take(&u->f->arena, ARENA_OTHER, 2 * u->cap, sizeof *more);
        if (!more)
            abort();
        memcpy(more, u->found, (size_t)u->n * sizeof *more);
        arena_give(&u->f->arena, u->found);
        u->found = more;
        u->cap *= 2;
    }
    u->found[u->n++] = p;
}

static int two_ascending(const void *a, const void *b)
{
    const int32_t *p = a, *q = b;
    if (p[0] != q[0])
        return p[0] < q[0] ? -1 : 1;
    return p[1] < q[1] ? -1 : p[1] > q[1];
}

/* Finds the edges of all triangles, each once, and the mesh of each. */
static void find_edges(struct brute *u)
{
    struct fabric *f = u->f;
    int64_t n = 0;
    for (int32_t t = 0; t < f->scene.tris; t++)
        for (int k = 0; k < 3; k++) {
            int32_t a = f->tri[t][k], b = f->tri[t][(k + 1) % 3];
            u->edge[2 * n] = a < b ? a : b;
            u->edge[2 * n + 1] = a < b ? b : a;
            n += a != b;
        }
    qsort(u->edge, (size_t)n, 2 * sizeof *u->edge, two_ascending);
    for (int64_t k = 0; k < n; k++)
        if (k == 0 || two_ascending(u->edge + 2 * k, u->edge + 2 * k - 2)) {
            u->edge[2 * u->n_edge] = u->edge[2 * k];
            u->edge[2 * u->n_edge + 1] = u->edge[2 * k + 1];
            u->of_edge[u->n_edge++] = u->of_vertex[u->edge[2 * k]];
        }
}

static void find_boxes(struct brute *u)
{
    const struct fabric *f = u->f;
    for (int32_t v = 0; v < f->scene.vertices; v++)
        u->vertex[v] = box_vertex(f->x0, f->x1, v);
    for (int64_t k = 0; k < u->n_edge; k++)
        u->side[k] = box_edge(f->x0, f->x1, u->edge[2 * k], u->edge[2 * k + 1]);
}

static void all_vf(struct brute *u)
{
    struct fabric *f = u->f;
    for (int32_t t = 0; t < f->scene.tris; t++) {
        const int32_t *g = f->tri[t];
        struct box face = box_face(f->x0, f->x1, g);
        for (int32_t v = 0; v < f->scene.vertices; v++) {
            if (u->of_vertex[v] < 0 || v == g[0] || v == g[1] || v == g[2] ||
                !compared(u, u->of_vertex[v], u->of_vertex[g[0]]) ||
                !box_meets(&face, &u->vertex[v], u->reach))
                continue;
            struct fabric_pair p = {0, {v, g[0], g[1], g[2]}};
            add(u, p);
        }
    }
}

static void all_ee(struct brute *u)
{
    const struct box *box = u->side;
    for (int64_t k = 0; k < u->n_edge; k++) {
        const int32_t *e = u->edge + 2 * k;
        for (int64_t l = k + 1; l < u->n_edge; l++) {
            const int32_t *g = u->edge + 2 * l;
            if (e[0] == g[0] || e[0] == g[1] || e[1] == g[0] || e[1] == g[1] ||
                !compared(u, u->of_edge[k], u->of_edge[l]) ||
                !box_meets(&box[k], &box[l], u->reach))
                continue;
            struct fabric_pair p = {1, {e[0], e[1], g[0], g[1]}};
            add(u, p);
        }
    }
}

struct fabric_pair *fabric_brute(struct fabric *f, bool self, real r,
                                 int64_t *n)
{
    struct arena *a = &f->arena;
    int64_t edges = 3 * (int64_t)f->scene.tris;
    struct brute u = {.f = f, .self = self, .reach = box_reach(r), .cap = 1024};
    u.edge = arena_take(a, ARENA_OTHER, 2 * edges, sizeof *u.edge);
    u.of_edge = arena_take(a, ARENA_OTHER, edges, sizeof *u.of_edge);
    u.of_vertex =
        arena_take(a, ARENA_OTHER, f->scene.vertices, sizeof *u.of_vertex);
    u.vertex = arena_take(a, ARENA_OTHER, f->scene.vertices, sizeof *u.vertex);
    u.side = arena_take(a, ARENA_OTHER, edges, sizeof *u.side);
    u.found = arena_take(a, ARENA_OTHER, u.cap, sizeof *u.found);
    if (a->failed)
        abort();
    for (int32_t v = 0; v < f->scene.vertices; v++)
        u.of_vertex[v] = -1;
    for (int32_t k = 0; k < f->scene.meshes; k++)
        for (int32_t t = 0; t < f->mesh[k].tris; t++)
            for (int c = 0; c < 3; c++)
                u.of_vertex[f->tri[f->mesh[k].first_tri + t][c]] = k;
    find_edges(&u);
    find_boxes(&u);
    all_vf(&u);
    all_ee(&u);
    arena_give(a, u.edge);
    arena_give(a, u.of_edge);
    arena_give(a, u.of_vertex);
    arena_give(a, u.vertex);
    arena_give(a, u.side);
    qsort(u.found, (size_t)u.n, sizeof *u.found, fabric_compare);
    *n = u.n;
    return u.found;
}

struct fabric_pair *fabric_found(struct fabric *f, const struct broad *b,
                                 int64_t *n)
{
    struct fabric_pair *p = arena_take(&f->arena, ARENA_OTHER, b->n, sizeof *p);
    if (!p)
        abort();
    for (int64_t k = 0; k < b->n; k++) {
        p[k].kind = broad_kinds(b)[k];
        memcpy(p[k].v, broad_pairs(b)[k], sizeof p[k].v);
    }
    qsort(p, (size_t)b->n, sizeof *p, fabric_compare);
    *n = b->n;
    return p;
}
