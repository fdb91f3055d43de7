/* SPDX-License-Identifier: Apache-2.0 */
/* Triangle meshes: from files, and laid in place. */
#ifndef APP_MESH_H
#define APP_MESH_H

#include "app/pool.h"

#include <stdbool.h>
#include <stdint.h>

struct mesh {
    int64_t nv, nt;
    double (*x)[3];    /* [nv] */
    int32_t (*tri)[3]; /* [nt] each 0 … nv-1 */
};

/* Reads a file by its ending: PLY and OFF by our own readers, in binary64,
 * OBJ, STL, glTF, COLLADA and FBX by assimp in a child process. PLY keeps the
 * order of vertices; in all others, those at one place become one. Polygons
 * become triangles. Returns app_exit after one line where something is wrong:
 * another ending, an empty mesh, a number that is not finite, an index out of
 * range or with a fraction. No other thread may run yet. */
int mesh_load(struct pool *pool, const char *path, struct mesh *mesh);

/* A triangle with two equal corners or no area in binary64. */
int64_t mesh_degenerate(const struct mesh *mesh);

/* How a mesh is laid in the scene, in this order. */
struct placement {
    double up[3];          /* this direction becomes +y; 0: as it is */
    double size;           /* largest dimension becomes this; 0: as it is */
    double scale;          /* factor */
    int stand;             /* least y becomes 0, x and z are centred */
    double axis[3], angle; /* turned about the axis by degrees */
    double at[3];          /* moved */
};
void mesh_place(struct mesh *mesh, const struct placement *placement);

/* The box around the mesh. */
void mesh_box(const struct mesh *mesh, double lo[3], double hi[3]);

/* The readers of one format each: app_exit after one line. */
int ply_load(struct pool *pool, const char *path, struct mesh *mesh);
int off_load(struct pool *pool, const char *path, struct mesh *mesh);
/* bits: 32 writes floats, 64 doubles. false after one line. */
bool ply_save(const char *directory, const char *name, const struct mesh *mesh,
              int bits);
bool obj_save(const char *directory, const char *name, const struct mesh *mesh,
              int bits);

#endif
