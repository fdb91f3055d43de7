/* SPDX-License-Identifier: Apache-2.0 */
/* Types and functions that the source files of the BVH builder share.
 * spec/broad/tree.md */
#ifndef REF_TREE_PLAN_H
#define REF_TREE_PLAN_H

#include "ref/broad/tree.h"

/* First node and number of nodes of each level of a mesh. */
struct tree_run {
    int32_t first[TREE_LEVELS], nodes[TREE_LEVELS];
};

/* A tree under construction. Its streams are writable. */
struct tree_plan {
    const struct tree_scene *scene;
    struct tree *tree;
    int32_t *first, *parent, *order, *place, *range, *at;
    uint8_t *count, *level, *rank, *own, *full;
    uint16_t *mesh;
    struct tree_grid *grid;
    int64_t grids, n_at, n_most; /* n_most: an upper bound of the nodes */
};

/* Returns the number of nodes a side at a level; a node spans 2^level cells. */
static inline int32_t tree_side(int32_t cells, int level)
{
    return (cells + ((1 << level) - 1)) >> level;
}

int tree_grid_levels(const struct tree_mesh *g);
/* Fills the lookup table of mesh k from p->n_at on, and run->nodes. Returns
 * DRAPE_OK, or DRAPE_EARG where triangles do not follow the cells. */
int tree_grid_mark(struct tree_plan *p, int32_t k, struct tree_run *run);
/* Fills the nodes of mesh k from the root down. */
void tree_grid_fill(struct tree_plan *p, int32_t k, const struct tree_run *run);

/* Sets own[t] (tree.h) of every triangle: the lowest-numbered triangle with a
 * vertex or edge represents it. Returns DRAPE_OK or DRAPE_ENOMEM. */
int tree_own(const struct tree_scene *s, struct arena *arena, uint8_t *own);

/* Makes the lists of the triangles around each vertex. Returns DRAPE_OK or
 * DRAPE_ENOMEM. */
int tree_one_rings(const struct tree_scene *s, struct arena *arena,
                   struct one_rings *one_rings);

#endif
