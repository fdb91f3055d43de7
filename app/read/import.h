/* SPDX-License-Identifier: Apache-2.0 */
/* Reads meshes in formats that assimp knows. assimp runs in a child process, so
 * that a damaged file cannot end the tool. */
#ifndef APP_READ_IMPORT_H
#define APP_READ_IMPORT_H

#include "app/base/pool.h"
#include "app/read/triangles.h"

#include <stdbool.h>

/* The header that the child sends before mesh->x and mesh->tri. */
struct import_reply {
    char magic[8];
    int64_t nv, nt;  /* of the mesh */
    int64_t frames;  /* of the animation that is taken; their positions follow
                        the mesh */
    int64_t several; /* 1: the file has more animations than the one taken */
    char clips[256]; /* the names of its animations */
    char error[512]; /* why there is no mesh; empty: a mesh follows */
};
#define IMPORT_MAGIC "drape\3m"
/* Frames a second that an animation is cut into, and how many at most. */
enum { IMPORT_RATE = 60, IMPORT_FRAMES = 1 << 20 };

/* Reads the file by assimp and sends it to `out`; the child ends here. clip:
 * the name of an animation; NULL: the first, if there is one; empty: none. */
_Noreturn void import_child(const char *path, const char *clip, int out);

/* Whether the file's extension is one that assimp reads. */
bool import_knows(const char *path);
/* Reads the mesh as the file has it, in metres, with unchecked indices; and its
 * animation, unless clip is NULL: then the mesh is as it is at rest. APP_OK, or
 * the exit code after one line. Call it before any other thread is started. */
int import_load(struct pool *pool, const char *path, struct clip *clip,
                struct mesh *mesh);

#endif
