/* SPDX-License-Identifier: Apache-2.0 */
/* Stage extent: bounds the positions and the tangents of whole cloths, for the
 * test of ref/broad/apart.h. spec/broad/extent.md */
#ifndef REF_EXTENT_H
#define REF_EXTENT_H

#include "ref/broad/box.h"
#include "ref/broad/cones.h"

/* Bounds of a whole mesh. */
struct mesh_bounds {
    struct box box;           /* of its vertices */
    struct tangents tangents; /* of a grid's cells, cones.md §2 */
};

struct extent {
    int64_t nv, n_grid;
    const struct tree_grid *grid; /* [n_grid] */
    const vec *x0, *x1;           /* [nv] m, start and end */
    struct mesh_bounds *bounds;   /* out: [n_grid] */
};

/* DRAPE_OK, or DRAPE_EDATA where a position of a grid is NaN or out of
 * range. */
int ref_extent(struct extent *s);

#endif
