/* SPDX-License-Identifier: Apache-2.0 */
/* How far the cloths of a run are stretched, by the sides of their cells. */
#ifndef APP_WRITE_STRETCH_H
#define APP_WRITE_STRETCH_H

#include "app/read/mesh.h"

#include <drape.h>

struct stretch {
    double most; /* the largest length of a side by its length at rest */
    int frame;   /* in which it was seen */
};

/* Looks at a frame of the cloths: x of all their vertices, and the triangles of
 * all, of which the cloths have part[k].nt each. stretch: [cloths] */
void stretch_look(struct stretch *stretch, const drape_cloth *cloth,
                  const struct part *part, int cloths, const struct mesh *mesh,
                  int frame);
/* Prints a note for each cloth that was more than twice as long somewhere. */
void stretch_tell(const struct stretch *stretch, const struct part *part,
                  int cloths);

#endif
