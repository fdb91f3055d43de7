/* SPDX-License-Identifier: Apache-2.0 */
/* Where triangles intersect, by drape's exact audit, and in which regions. */
#ifndef APP_READ_CROSSINGS_H
#define APP_READ_CROSSINGS_H

#include "app/base/pool.h"

#include <drape.h>
#include <stdbool.h>

/* Pairs of triangles that intersect. */
struct crossings {
    int64_t found, sewn, degenerate; /* sewn: pairs that a seam joins */
    int32_t (*pair)[2];              /* [found] ascending */
};

/* Finds the pairs of a mesh. Returns app_exit; crossings_free gives back what
 * it holds in any case. */
int crossings_find(const drape_mesh *mesh, struct crossings *crossings);
/* Takes out the pairs that a seam of the world joins, and counts them. */
void crossings_part(struct crossings *crossings, const drape_world *world);
void crossings_free(struct crossings *crossings);

/* The triangle beyond each edge of a triangle, its edge k being opposite corner
 * k; -1: none. beyond: [nt][3]. APP_OK, or APP_FAILED after one line. */
int crossings_adjacent(const drape_mesh *mesh, int32_t (*beyond)[3]);

/* Connected sets of pairs. Two pairs are neighbours if they have one triangle
 * in common, and their others an edge. So one surface is on side 0 of all pairs
 * of a region, and the other on side 1. */
struct regions {
    int count;
    int32_t *of;  /* [pairs] the region of each */
    bool *turned; /* [pairs] side 0 is the second triangle */
};
/* Finds them; they are the pool's. APP_OK, or APP_FAILED after one line. */
int crossings_group(struct pool *pool, const struct crossings *crossings,
                    const int32_t (*beyond)[3], struct regions *regions);

#endif
