/* SPDX-License-Identifier: Apache-2.0 */
/* Decides whether any two meshes that a query compares, or a cloth and itself,
 * can come within reach of each other. If they cannot, the query has no
 * candidates and the tree is skipped. This test runs on the host for both
 * backends. spec/broad/extent.md §2 */
#ifndef REF_APART_H
#define REF_APART_H

#include "ref/broad/tree.h"

struct mesh_bounds;

struct apart {
    bool able;          /* false: §2 does not apply to some pair, so the
                           test is never made */
    int64_t n;          /* pairs */
    int32_t (*pair)[2]; /* [n] two meshes; equal: a cloth with itself */
    struct mesh_bounds *bounds; /* [meshes] grids first, as stage extent writes
                            them; static meshes hold their box only */
};

/* Makes the list of mesh pairs from the root pairs of the scene's tree, and the
 * boxes of static meshes. Returns DRAPE_OK or DRAPE_ENOMEM. */
int apart_make(struct apart *a, const struct tree_scene *scene,
               const struct tree *tree, const struct tree_map *map,
               int64_t roots, const int32_t (*root)[2], struct arena *arena);

/* Whether no pair of meshes can come within r. Stage extent must have written
 * a->bounds for this query. */
bool apart_all(const struct apart *a, real r);

#endif
