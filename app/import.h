/* SPDX-License-Identifier: Apache-2.0 */
/* Meshes in formats that assimp reads. It runs in a child process, so that
 * no file can take the tool down. */
#ifndef APP_IMPORT_H
#define APP_IMPORT_H

#include "app/mesh.h"

/* What the child sends before mesh->x and mesh->tri. */
struct import_reply {
    char magic[8];
    int64_t nv, nt;  /* of the mesh */
    char error[512]; /* why there is no mesh; empty: there is one */
};
#define IMPORT_MAGIC "drape\2m"

/* Reads the file by assimp and sends it to `out`; the child ends here. */
_Noreturn void import_child(const char *path, int out);

/* Whether the file's ending is one of those that go to assimp. */
bool import_knows(const char *path);
/* The mesh as the file has it; its indices may be anything. APP_OK, or the
 * exit code after one line. Call it before any other thread is started. */
int import_load(struct pool *pool, const char *path, struct mesh *mesh);

#endif
