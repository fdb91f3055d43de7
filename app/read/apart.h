/* SPDX-License-Identifier: Apache-2.0 */
/* Parts of a body that come near or through each other give way, so that cloth
 * between them has room: app/scenes/README.md, key `apart`. */
#ifndef APP_READ_APART_H
#define APP_READ_APART_H

#include "app/base/pool.h"
#include "app/read/triangles.h"

#include <stdbool.h>

/* A region of a frame: vertices that gave way and that edges join. */
struct parted {
    int body, frame; /* number of the obstacle, and of its frame */
    int64_t first, vertices;
    double depth; /* m, the largest way */
    double at[3]; /* m, the middle of them before */
    int64_t left; /* vertices with too little room all the same */
    bool parted;  /* false: it was left as it was */
};
struct parted_list {
    struct parted *row; /* [count] */
    int count, room;
};

/* Moves vertices of each frame [frames][mesh->nv] inwards until `room`, m, is
 * between surfaces that face each other, and appends what has moved, or cannot.
 * The mesh is closed. APP_OK, or APP_FAILED after one line. */
int apart(struct pool *pool, const struct mesh *mesh, double (*x)[3],
          int frames, double room, struct parted_list *list);
/* Whether each edge of a mesh has one triangle on either side. -1: there is no
 * memory. */
int apart_closed(const struct mesh *mesh);

#endif
