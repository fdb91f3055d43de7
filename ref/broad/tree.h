/* SPDX-License-Identifier: Apache-2.0 */
/* The bounding-volume hierarchy (BVH) of every mesh of a scene, in one
 * stream of nodes. The host builds it once from the rest positions.
 * spec/broad/tree.md */
#ifndef REF_TREE_H
#define REF_TREE_H

#include "ref/base/arena.h"
#include "ref/base/stage.h"

/* The triangles around each vertex. spec/broad/tree.md §4 */
struct one_rings {
    int64_t n_start,
        n_opposite;       /* vertices + 1, 3 · triangles; 0: none known */
    const int32_t *start; /* [n_start] the list of vertex v is
                             opposite[start[v]] … opposite[start[v + 1] - 1] */
    const int32_t (*opposite)[2]; /* [n_opposite] the other two vertices of a
                                triangle, in its order; triangles ascend */
};

enum { TREE_LEVELS = 20, TREE_CLASSES = 3 };

/* Classes of nodes, in the order of the stream. */
enum tree_class { TREE_CLOTH, TREE_MOVING, TREE_STATIC };

/* A mesh is a run of the scene's triangles. */
struct tree_mesh {
    int kind;                /* enum tree_class; cloth: a grid */
    int32_t base, m, n;      /* of a grid: particle (i, j) is base + i + m j */
    int32_t first_tri, tris; /* a grid's triangles go cell by cell, row-major */
    bool self;               /* its triangles are tested against each other */
    int size; /* as tree_size tells it; 0: by the scene's positions */
};

/* The lookup table of a grid's nodes. Level l has ceil(cells / 2^l) nodes a
 * side. */
struct tree_grid {
    int32_t base, m, n;
    int32_t at[TREE_LEVELS]; /* offset of level l in tree_map.at */
};

/* Read-only streams that all stages of the broad phase share. Level 0 holds the
 * leaves. Nodes are ordered by class, then by level, then by mesh; in a mesh
 * the children of a node are contiguous. */
struct tree {
    int64_t n, n_cloth;      /* nodes; those of cloth come first */
    int64_t n_tri, levels;   /* levels: of the mesh that has most */
    int64_t n_range;         /* TREE_CLASSES · levels + 1 */
    const int32_t *first;    /* [n] first child; of a leaf: index into order */
    const int32_t *parent;   /* [n] -1 for a root */
    const uint8_t *count;    /* [n] 1 … 4 children or triangles */
    const uint8_t *level;    /* [n] 0: a leaf */
    const uint8_t *rank;     /* [n] level + offset of the mesh: log2 of size */
    const uint16_t *mesh;    /* [n] */
    const int32_t *order;    /* [n_tri] triangles, leaf after leaf */
    const int32_t (*tri)[3]; /* [n_tri] vertices */
    const uint8_t *own;      /* [n_tri] bits 0–2: the triangle represents its
                                vertex k; bits 3–5: its edge from vertex k to
                                k + 1 */
    struct one_rings one_rings; /* of all triangles */
    const int32_t *place; /* [n_cloth] I | J << 16: position in its level */
    const int32_t *range; /* [n_range] first node of class c, level l at
                             c · levels + l */
};

/* The lookup tables of grids, which stage cones needs besides the tree.
 * spec/broad/cones.md */
struct tree_map {
    int64_t n_grid, n_at;
    const struct tree_grid *grid; /* [n_grid], by mesh number */
    const int32_t *at;            /* [n_at] node at (level, I, J), -1: none */
    const uint8_t *full; /* [n_cloth] 1: the node is full, tree.md §2 */
};

/* The input of tree_build. Grids come first among the meshes. */
struct tree_scene {
    int32_t meshes, vertices, tris;
    const struct tree_mesh *mesh;
    const int32_t (*tri)[3];
    const vec *x; /* m, [vertices] positions at rest */
};

/* Returns floor(log2) of a mesh's longest side in metres, at least -60, plus a
 * constant that makes it positive. */
int tree_size(const struct tree_scene *s, const struct tree_mesh *g);

/* Builds the BVH. Returns DRAPE_OK, DRAPE_ENOMEM or DRAPE_EARG. The arena owns
 * the new streams; tri stays the scene's. */
int tree_build(const struct tree_scene *scene, struct arena *arena,
               struct tree *tree, struct tree_map *map);

/* Returns the number of inner nodes of cloth, which follow the leaves of
 * cloth. */
static inline int64_t tree_inner(const struct tree *t)
{
    return t->n_cloth > 0 ? t->n_cloth - t->range[1] : 0;
}

/* Pairs of nodes, spec/broad/front.md §1. */

/* Says which nodes of a pair are replaced by their children: bit 0 the first
 * node, bit 1 the second. 0 means that both are leaves. */
static inline int tree_descends(const struct tree *t, int32_t a, int32_t b)
{
    bool leaf_a = t->level[a] == 0, leaf_b = t->level[b] == 0;
    int ra = t->rank[a], rb = t->rank[b];
    return (!leaf_a && (ra >= rb || leaf_b) ? 1 : 0) |
           (!leaf_b && (rb >= ra || leaf_a) ? 2 : 0);
}

/* Replaces (a, b) by the pair of which it is a child. Returns false for a root
 * pair. */
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
