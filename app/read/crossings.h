/* SPDX-License-Identifier: Apache-2.0 */
/* Where triangles intersect, by drape's exact audit. */
#ifndef APP_READ_CROSSINGS_H
#define APP_READ_CROSSINGS_H

#include <drape.h>

/* Pairs of triangles that intersect. */
struct crossings {
    int64_t found, sewn, degenerate; /* sewn: pairs that a seam joins */
    int32_t (*pair)[2];              /* [found] */
};

/* Finds the pairs of a mesh. Returns app_exit; crossings_free gives back what
 * it holds in any case. */
int crossings_find(const drape_mesh *mesh, struct crossings *crossings);
/* Takes out the pairs that a seam of the world joins, and counts them. */
void crossings_part(struct crossings *crossings, const drape_world *world);
void crossings_free(struct crossings *crossings);

#endif
