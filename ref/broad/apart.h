/* SPDX-License-Identifier: Apache-2.0 */
/* Whether whole meshes can come near each other, or a cloth itself.
 * spec/broad/extent.md §2. What is decided here is the host's, for both
 * backends. */
#ifndef REF_APART_H
#define REF_APART_H

#include "ref/broad/extent.h"

struct apart {
    bool able;           /* §2 covers all pairs of this scene */
    int64_t n;           /* pairs */
    int32_t (*pair)[2];  /* [n] meshes; twice the same: with itself */
    struct whole *whole; /* [meshes] grids first; of static ones the box */
};

/* Of a scene, whose roots are pairs of nodes of the tree.
 * DRAPE_OK or DRAPE_ENOMEM. */
int apart_make(struct apart *a, const struct tree_scene *scene,
               const struct tree *tree, const struct tree_map *map,
               int64_t roots, const int32_t (*root)[2], struct arena *arena);

/* Whether no pair comes within r, of what stage extent wrote to whole. */
bool apart_all(const struct apart *a, real r);

#endif
