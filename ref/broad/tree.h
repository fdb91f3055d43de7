/* SPDX-License-Identifier: Apache-2.0 */
/* The hierarchy of every mesh of a scene, in one stream of nodes, built once
 * at rest on the host. spec/broad/tree.md */
#ifndef REF_TREE_H
#define REF_TREE_H

#include "ref/base/arena.h"
#include "ref/base/stage.h"

enum { TREE_LEVELS = 20, TREE_CLASSES = 3 };

/* Classes of nodes, in the order of the stream. */
enum tree_class { TREE_CLOTH, TREE_MOVING, TREE_STATIC };

/* A mesh: a run of the scene's triangles. */
struct tree_mesh {
    int kind;                /* enum tree_class; cloth: a grid */
    int32_t base, m, n;      /* of a grid: particle (i,j) is base + i + m j */
    int32_t first_tri, tris; /* a grid's: cell after cell, row-major */
    bool self;               /* its own triangles may touch */
};

/* A grid's table of nodes: level l has ceil(cells / 2^l) a side. */
struct tree_grid {
    int32_t base, m, n;
    int32_t at[TREE_LEVELS]; /* offset of level l in tree_map.at */
};

/* Read-only streams that every stage of the broad phase shares. Level 0 are
 * the leaves. Nodes lie class after class, in a class level after level, in a
 * level mesh after mesh, in a mesh so that children are contiguous. */
struct tree {
    int64_t n, n_cloth;      /* nodes; those of cloth come first */
    int64_t n_tri, levels;   /* levels: of the highest mesh */
    int64_t n_range;         /* TREE_CLASSES · levels + 1 */
    const int32_t *first;    /* [n] first child; of a leaf: index into order */
    const int32_t *parent;   /* [n] -1: a root */
    const uint8_t *count;    /* [n] 1 … 4 children or triangles */
    const uint8_t *level;    /* [n] 0: a leaf */
    const uint8_t *rank;     /* [n] level + a mesh's offset: log2 of its size */
    const uint16_t *mesh;    /* [n] */
    const int32_t *order;    /* [n_tri] triangles, leaf after leaf */
    const int32_t (*tri)[3]; /* [n_tri] vertices */
    const uint8_t *own;      /* [n_tri] bits 0–2: it represents vertex k, bits
                                3–5: edge k, from vertex k to k + 1 */
    const int32_t *place;    /* [n_cloth] I | J << 16: place in its level */
    const int32_t *range;    /* [n_range] first node of class c, level l at
                                c · levels + l */
};

/* What the cones need besides: spec/broad/cones.md. */
struct tree_map {
    int64_t n_grid, n_at;
    const struct tree_grid *grid; /* [n_grid], by mesh number */
    const int32_t *at;            /* [n_at] node at (level, I, J), -1: none */
    const uint8_t *full; /* [n_cloth] 1: all its cells have two triangles */
};

/* What a tree is built from. Grids come first among the meshes. */
struct tree_scene {
    int32_t meshes, vertices, tris;
    const struct tree_mesh *mesh;
    const int32_t (*tri)[3];
    const vec *x; /* at rest */
};

/* DRAPE_OK, DRAPE_ENOMEM or DRAPE_EARG. The streams are the arena's, but for
 * tri, which stays the scene's. */
int tree_build(const struct tree_scene *scene, struct arena *arena,
               struct tree *tree, struct tree_map *map);

/* Cloth nodes that are no leaves; they follow these. */
static inline int64_t tree_inner(const struct tree *t)
{
    return t->n_cloth > 0 ? t->n_cloth - t->range[1] : 0;
}

/* ---- Pairs of nodes: spec/broad/front.md §1 ---- */

/* Bit 0: a pair's first node descends, bit 1: its second. 0: leaves. */
static inline int tree_descends(const struct tree *t, int32_t a, int32_t b)
{
    bool leaf_a = t->level[a] == 0, leaf_b = t->level[b] == 0;
    int ra = t->rank[a], rb = t->rank[b];
    return (!leaf_a && (ra >= rb || leaf_b) ? 1 : 0) |
           (!leaf_b && (rb >= ra || leaf_a) ? 2 : 0);
}

/* The pair from which (a, b) descended, in place; false at roots. */
static inline bool tree_ascend(const struct tree *t, int32_t *a, int32_t *b)
{
    int32_t pa = t->parent[*a], pb = t->parent[*b];
    if (pa < 0 && pb < 0)
        return false;
    bool up_a = pb < 0 || (pa >= 0 && t->rank[*a] <= t->rank[*b]);
    bool up_b = pa < 0 || (pb >= 0 && t->rank[*b] <= t->rank[*a]);
    *a = up_a ? pa : *a;
    *b = up_b ? pb : *b;
    return true;
}

#endif
