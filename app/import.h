/* SPDX-License-Identifier: Apache-2.0 */
/* Reads meshes in formats that assimp knows. assimp runs in a child process, so
 * that a damaged file cannot end the tool. */
#ifndef APP_IMPORT_H
#define APP_IMPORT_H

#include "app/pool.h"
#include "app/triangles.h"

#include <stdbool.h>

/* The header that the child sends before mesh->x and mesh->tri. */
struct import_reply {
    char magic[8];
    int64_t nv, nt;  /* of the mesh */
    char error[512]; /* why there is no mesh; empty: a mesh follows */
};
#define IMPORT_MAGIC "drape\2m"

/* Reads the file by assimp and sends it to `out`; the child ends here. */
_Noreturn void import_child(const char *path, int out);

/* Whether the file's extension is one that assimp reads. */
bool import_knows(const char *path);
/* Reads the mesh as the file has it, with unchecked indices. APP_OK, or the
 * exit code after one line. Call it before any other thread is started. */
int import_load(struct pool *pool, const char *path, struct mesh *mesh);

#endif
