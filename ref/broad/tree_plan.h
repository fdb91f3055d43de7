/* SPDX-License-Identifier: Apache-2.0 */
/* What the parts of the tree's builder share. spec/broad/tree.md */
#ifndef REF_TREE_PLAN_H
#define REF_TREE_PLAN_H

#include "ref/broad/tree.h"

/* A mesh's nodes, level by level. */
struct tree_run {
    int32_t first[TREE_LEVELS], nodes[TREE_LEVELS];
};

/* A tree under construction: its streams, writable. */
struct tree_plan {
    const struct tree_scene *scene;
    struct tree *tree;
    int32_t *first, *parent, *order, *place, *range, *at;
    uint8_t *count, *level, *rank, *own, *full;
    uint16_t *mesh;
    struct tree_grid *grid;
    int64_t grids, n_at, n_most; /* n_most: a bound of the nodes */
};

/* Cells or nodes a side, 2^level of the cells in one. */
static inline int32_t tree_side(int32_t cells, int level)
{
    return (cells + ((1 << level) - 1)) >> level;
}

int tree_grid_levels(const struct tree_mesh *g);
/* The table of mesh k, from p->n_at on, and its nodes[level]: DRAPE_OK, or
 * DRAPE_EARG where triangles do not follow the cells. */
int tree_grid_mark(struct tree_plan *p, int32_t k, struct tree_run *run);
/* The nodes of mesh k from the root down. */
void tree_grid_fill(struct tree_plan *p, int32_t k, const struct tree_run *run);

/* own[t] for every triangle, tree.h: the lowest-numbered triangle of a vertex
 * or edge represents it. DRAPE_OK or DRAPE_ENOMEM. */
int tree_own(const struct tree_scene *s, struct arena *arena, uint8_t *own);

#endif
