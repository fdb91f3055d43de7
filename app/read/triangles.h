/* SPDX-License-Identifier: Apache-2.0 */
/* A triangle mesh in memory, as the tool's readers, writers and shapes share
 * it. */
#ifndef APP_READ_TRIANGLES_H
#define APP_READ_TRIANGLES_H

#include <stdint.h>

struct mesh {
    int64_t nv, nt;
    double (*x)[3];    /* [nv] */
    int32_t (*tri)[3]; /* [nt] each 0 … nv-1 */
};

/* The animation of a mesh file, as frames of the mesh. */
struct clip {
    const char *name; /* NULL: the file's first, if there is one */
    int frames;       /* out: 0: nothing moves */
    double dt;        /* out: s between frames */
    double (*x)[3];   /* out: [frames][nv], the first as the mesh is */
    char others[256]; /* out: the names of all, if there are several and none
                         was named */
};

#endif
