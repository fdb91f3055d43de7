/* SPDX-License-Identifier: Apache-2.0 */
/* Parts of a body that come near or through each other give way:
 * app/scenes/README.md, key `apart`. */
#include "app/read/apart.h"
#include "app/base/app.h"
#include "app/base/vec3.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Surfaces face each other if their normals are more than 120 degrees apart. */
static const double facing = -0.5;
/* Ways below this part of the room are none. */
static const double none = 1e-3;
/* No vertex gives way by more, m: what is deeper is no flesh that yields. */
static const double deepest = 0.02;
/* A region in which a larger part of the vertices has too little room does not
 * part, as parts are one in the other there. */
static const double most_left = 0.1;
enum {
    ROUNDS = 6,  /* as a normal is not that of what it meets */
    SPREADS = 2, /* to neighbours, so that no corner stays behind */
    LEAF = 4,    /* triangles of a leaf */
    DEEP = 96    /* levels of a tree of 2^32 triangles are fewer, as each has at
                    most three quarters of the one above */
};

struct node {
    double lo[3], hi[3];
    int64_t first, count; /* triangles of a leaf; count 0: children are first
                             and first + 1 */
};

struct tree {
    const struct mesh *mesh;
    double (*x)[3];                     /* [nv] of the frame */
    double (*normal)[3];                /* [nv] of length 1 */
    double (*face)[3];                  /* [nt] likewise */
    double *way, *mean, *share, *moved; /* [nv] */
    bool *deep; /* [nv] it is further in another part than it can give way */
    int64_t *order, *group; /* [nt] triangles; [nv] */
    struct node *node;      /* [2 nt] */
    int64_t nodes;
    double room, none; /* m; ways up to the latter are none */
};

/* Normals of triangles, and of vertices by the areas around them. */
static void find_normals(struct tree *t)
{
    memset(t->normal, 0, (size_t)t->mesh->nv * sizeof *t->normal);
    for (int64_t k = 0; k < t->mesh->nt; k++) {
        const int32_t *v = t->mesh->tri[k];
        double a[3], b[3];
        vec3_subtract(t->x[v[1]], t->x[v[0]], a);
        vec3_subtract(t->x[v[2]], t->x[v[0]], b);
        vec3_cross(a, b, t->face[k]);
        for (int i = 0; i < 9; i++)
            t->normal[v[i / 3]][i % 3] += t->face[k][i % 3];
        vec3_normalise(t->face[k]);
    }
    for (int64_t k = 0; k < t->mesh->nv; k++)
        vec3_normalise(t->normal[k]);
}

static double middle(const struct tree *t, int64_t triangle, int axis)
{
    const int32_t *v = t->mesh->tri[triangle];
    return t->x[v[0]][axis] + t->x[v[1]][axis] + t->x[v[2]][axis];
}

static void find_box(const struct tree *t, struct node *n)
{
    for (int i = 0; i < 3; i++) {
        n->lo[i] = INFINITY;
        n->hi[i] = -INFINITY;
    }
    for (int64_t k = n->first; k < n->first + n->count; k++)
        for (int c = 0; c < 9; c++) {
            double a = t->x[t->mesh->tri[t->order[k]][c / 3]][c % 3];
            n->lo[c % 3] = fmin(n->lo[c % 3], a);
            n->hi[c % 3] = fmax(n->hi[c % 3], a);
        }
}

/* Parts the triangles of a node at the middle of its longest side; returns how
 * many are in the lower part. */
static int64_t part_node(struct tree *t, const struct node *n)
{
    int axis = 0;
    for (int i = 1; i < 3; i++)
        axis = n->hi[i] - n->lo[i] > n->hi[axis] - n->lo[axis] ? i : axis;
    double at = 1.5 * (n->lo[axis] + n->hi[axis]);
    int64_t low = n->first;
    for (int64_t k = n->first; k < n->first + n->count; k++)
        if (middle(t, t->order[k], axis) < at) {
            int64_t swap = t->order[k];
            t->order[k] = t->order[low];
            t->order[low++] = swap;
        }
    low -= n->first;
    int64_t least = n->count / 4;
    return low > least && low < n->count - least ? low : n->count / 2;
}

static void build(struct tree *t)
{
    t->node[0] = (struct node){.count = t->mesh->nt};
    t->nodes = 1;
    for (int64_t k = 0; k < t->nodes; k++) {
        struct node *n = &t->node[k];
        find_box(t, n);
        if (n->count <= LEAF)
            continue;
        int64_t low = part_node(t, n);
        t->node[t->nodes] = (struct node){.first = n->first, .count = low};
        t->node[t->nodes + 1] =
            (struct node){.first = n->first + low, .count = n->count - low};
        n->first = t->nodes;
        n->count = 0;
        t->nodes += 2;
    }
}

/* What the normal's line through a vertex meets. */
struct meeting {
    int64_t vertex;
    double along[3];      /* the line */
    double ahead, behind; /* m, to the nearest surfaces that face the vertex's;
                             INFINITY: none */
    int inside; /* parts of the body in which the vertex's outside is */
};

static bool hits_box(const struct node *n, const double from[3],
                     const double along[3])
{
    double lo = -INFINITY, hi = INFINITY;
    for (int i = 0; i < 3; i++) {
        double a = (n->lo[i] - from[i]) / along[i];
        double b = (n->hi[i] - from[i]) / along[i];
        lo = fmax(lo, fmin(a, b));
        hi = fmin(hi, fmax(a, b));
    }
    return !(lo > hi);
}

static void meet(const struct tree *t, int64_t triangle, struct meeting *m)
{
    const int32_t *v = t->mesh->tri[triangle];
    if (v[0] == m->vertex || v[1] == m->vertex || v[2] == m->vertex)
        return;
    double a[3], b[3], c[3], p[3], q[3];
    vec3_subtract(t->x[v[1]], t->x[v[0]], a);
    vec3_subtract(t->x[v[2]], t->x[v[0]], b);
    vec3_subtract(t->x[m->vertex], t->x[v[0]], c);
    vec3_cross(m->along, b, p);
    vec3_cross(c, a, q);
    double size = vec3_dot(p, a), u = vec3_dot(c, p) / size,
           w = vec3_dot(m->along, q) / size;
    double at = vec3_dot(b, q) / size;
    if (!(u >= 0 && w >= 0 && u + w <= 1))
        return;
    double slant = vec3_dot(t->face[triangle], t->normal[m->vertex]);
    if (at > 0)
        m->inside += slant > 0 ? 1 : -1;
    if (slant >= facing)
        return;
    if (at > 0)
        m->ahead = fmin(m->ahead, at);
    else
        m->behind = fmin(m->behind, -at);
}

/* Finds how far a vertex is to give way: half of what lacks to the room, as
 * what it faces gives way, too. */
static void find_way(struct tree *t, int64_t vertex)
{
    struct meeting m = {vertex, {0}, INFINITY, INFINITY, 0};
    /* beside the normal, so that no line runs through edges of regular meshes
     */
    static const double beside[3] = {1.07e-3, 0.73e-3, -0.91e-3};
    for (int i = 0; i < 3; i++)
        m.along[i] = t->normal[vertex][i] + beside[i];
    int64_t stack[DEEP] = {0};
    for (int depth = 1; depth > 0;) {
        const struct node *n = &t->node[stack[--depth]];
        if (!hits_box(n, t->x[vertex], m.along))
            continue;
        for (int64_t k = n->first; k < n->first + n->count; k++)
            meet(t, t->order[k], &m);
        if (n->count == 0) {
            stack[depth++] = n->first;
            stack[depth++] = n->first + 1;
        }
    }
    double lacks = m.inside > 0 ? t->room + m.behind : t->room - m.ahead;
    t->deep[vertex] = m.inside > 0 && !(lacks < 2 * deepest);
    t->way[vertex] = t->deep[vertex] ? 0 : fmax(lacks, 0) / 2;
}

/* Lets neighbours give way by their mean at least. */
static void spread(struct tree *t)
{
    size_t nv = (size_t)t->mesh->nv;
    memset(t->mean, 0, nv * sizeof *t->mean);
    memset(t->share, 0, nv * sizeof *t->share);
    for (int64_t k = 0; k < t->mesh->nt; k++)
        for (int i = 0; i < 3; i++) {
            const int32_t *v = t->mesh->tri[k];
            t->mean[v[i]] += t->way[v[(i + 1) % 3]] + t->way[v[(i + 2) % 3]];
            t->share[v[i]] += 2;
        }
    for (size_t k = 0; k < nv; k++)
        if (t->share[k] > 0)
            t->way[k] = fmax(t->way[k], t->mean[k] / t->share[k]);
}

/* Finds the ways of all vertices; returns how many have one. */
static int64_t find_ways(struct tree *t)
{
    int64_t count = 0;
    find_normals(t);
    build(t);
    for (int64_t k = 0; k < t->mesh->nv; k++) {
        find_way(t, k);
        count += t->way[k] > t->none || t->deep[k];
    }
    return count;
}

static bool is_pressed(const struct tree *t, int64_t vertex)
{
    return t->moved[vertex] > 0 || t->deep[vertex];
}

static int64_t root_of(int64_t *group, int64_t k)
{
    while (group[k] != k)
        k = group[k] = group[group[k]];
    return k;
}

static struct parted *append(struct parted_list *list)
{
    if (list->count == list->room) {
        int room = list->room ? 2 * list->room : 64;
        struct parted *larger =
            realloc(list->row, (size_t)room * sizeof *larger);
        if (!larger)
            return NULL;
        list->row = larger;
        list->room = room;
    }
    return &list->row[list->count++];
}

/* Appends the regions of a frame, where from [nv] it moved, and puts those back
 * that do not part. */
static int name_regions(struct tree *t, const double (*from)[3], int frame,
                        struct parted_list *list)
{
    int64_t nv = t->mesh->nv, *group = t->group;
    for (int64_t k = 0; k < nv; k++)
        group[k] = k;
    for (int64_t k = 0; k < t->mesh->nt; k++)
        for (int i = 0; i < 3; i++) {
            int32_t a = t->mesh->tri[k][i], b = t->mesh->tri[k][(i + 1) % 3];
            if (is_pressed(t, a) && is_pressed(t, b)) {
                int64_t p = root_of(group, a), q = root_of(group, b);
                group[p > q ? p : q] = p > q ? q : p;
            }
        }
    for (int64_t root = 0; root < nv; root++) {
        if (!is_pressed(t, root) || root_of(group, root) != root)
            continue;
        struct parted *row = append(list);
        if (!row)
            return no_memory();
        *row = (struct parted){.frame = frame, .first = root};
        for (int64_t k = root; k < nv; k++) {
            if (!is_pressed(t, k) || root_of(group, k) != root)
                continue;
            row->vertices++;
            row->left += t->way[k] > t->none || t->deep[k];
            row->depth = fmax(row->depth, t->moved[k]);
            for (int i = 0; i < 3; i++)
                row->at[i] += from[k][i];
        }
        for (int i = 0; i < 3; i++)
            row->at[i] /= (double)row->vertices;
        row->parted = (double)row->left <= most_left * (double)row->vertices;
        for (int64_t k = root; k < nv && !row->parted; k++)
            if (is_pressed(t, k) && root_of(group, k) == root)
                memcpy(t->x[k], from[k], sizeof *t->x);
    }
    return APP_OK;
}

/* Parts one frame; was: [nv] scratch. */
static int part_frame(struct tree *t, int frame, double (*was)[3],
                      struct parted_list *list)
{
    int64_t nv = t->mesh->nv;
    int64_t left = find_ways(t);
    if (!left)
        return APP_OK;
    memcpy(was, t->x, (size_t)nv * sizeof *was);
    memset(t->moved, 0, (size_t)nv * sizeof *t->moved);
    for (int round = 0; left && round < ROUNDS; round++) {
        for (int k = 0; k < SPREADS; k++)
            spread(t);
        for (int64_t k = 0; k < nv; k++) {
            t->way[k] = fmin(t->way[k], deepest - t->moved[k]);
            t->moved[k] += t->way[k];
            for (int i = 0; i < 3; i++)
                t->x[k][i] -= t->way[k] * t->normal[k][i];
        }
        left = find_ways(t);
    }
    return name_regions(t, (const double(*)[3])was, frame, list);
}

int apart(struct pool *pool, const struct mesh *mesh, double (*x)[3],
          int frames, double room, struct parted_list *list)
{
    size_t nv = (size_t)mesh->nv, nt = (size_t)mesh->nt;
    struct tree t = {
        .mesh = mesh,
        .room = room,
        .none = none * room,
        .normal = pool_take(pool, nv, sizeof *t.normal),
        .face = pool_take(pool, nt, sizeof *t.face),
        .way = pool_take(pool, nv, sizeof *t.way),
        .mean = pool_take(pool, nv, sizeof *t.mean),
        .share = pool_take(pool, nv, sizeof *t.share),
        .moved = pool_take(pool, nv, sizeof *t.moved),
        .deep = pool_take(pool, nv, sizeof *t.deep),
        .order = pool_take(pool, nt, sizeof *t.order),
        .group = pool_take(pool, nv, sizeof *t.group),
        .node = pool_take(pool, 2 * nt, sizeof *t.node),
    };
    double(*was)[3] = pool_take(pool, nv, sizeof *was);
    if (!t.normal || !t.face || !t.way || !t.mean || !t.share || !t.moved ||
        !t.deep || !t.order || !t.group || !t.node || !was)
        return no_memory();
    for (size_t k = 0; k < nt; k++)
        t.order[k] = (int64_t)k;
    int status = APP_OK;
    for (int k = 0; k < frames && status == APP_OK; k++) {
        t.x = x + (size_t)k * nv;
        status = part_frame(&t, k, was, list);
    }
    return status;
}

static int compare(const void *a, const void *b)
{
    return memcmp(a, b, 2 * sizeof(int32_t));
}

int apart_closed(const struct mesh *mesh)
{
    size_t n = 3 * (size_t)mesh->nt;
    int32_t(*edge)[2] = malloc((2 * n + 1) * sizeof *edge), (*back)[2];
    if (!edge)
        return -1;
    back = edge + n;
    for (size_t k = 0; k < n; k++) {
        edge[k][0] = back[k][1] = mesh->tri[k / 3][k % 3];
        edge[k][1] = back[k][0] = mesh->tri[k / 3][(k + 1) % 3];
    }
    qsort(edge, n, sizeof *edge, compare);
    qsort(back, n, sizeof *back, compare);
    int same = memcmp(edge, back, n * sizeof *edge) == 0;
    for (size_t k = 1; k < n && same; k++)
        same = memcmp(edge[k], edge[k - 1], sizeof *edge) != 0;
    free(edge);
    return same;
}
