/* SPDX-License-Identifier: Apache-2.0 */
/* Triangle meshes: reading from files, and placement in a scene. */
#ifndef APP_READ_MESH_H
#define APP_READ_MESH_H

#include "app/base/pool.h"
#include "app/read/triangles.h"

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

/* Reads a mesh file by its extension: PLY and OFF by our own readers, in
 * binary64; OBJ, STL, glTF, COLLADA and FBX by assimp in a child process. PLY
 * keeps the order of vertices; the other formats merge vertices at the same
 * place. Lengths are in metres: those of FBX are converted from its unit.
 * Polygons become triangles. Returns app_exit; one line is printed for an
 * unknown extension, an empty mesh, a number that is not finite, or an index
 * that is out of range or has a fraction. No other thread may run yet. */
int mesh_load(struct pool *pool, const char *path, struct mesh *mesh);
/* The same, with the animation that the file may have, of its nodes, bones and
 * morph targets; clip: NULL: the mesh as it is at rest. */
int mesh_load_clip(struct pool *pool, const char *path, struct clip *clip,
                   struct mesh *mesh);

/* The same without an animation, and without merging: all vertices that the
 * reader gives, in its order. */
int mesh_load_plain(struct pool *pool, const char *path, struct mesh *mesh);
/* Merges, unless the file is PLY, vertices that are at the same place in all
 * frames of clip, which were loaded plainly. APP_OK, or APP_FAILED. */
int mesh_merge(const char *path, struct mesh *mesh, struct clip *clip);
/* Whether mesh_load_plain has vertices of such a file in the file's order. */
bool mesh_ordered(const char *path);
/* Reads the frames of a point cache (.pc2) of a mesh of nv vertices, behind
 * `room` frames that the caller fills; clip->dt is in frames. APP_OK, or the
 * exit code after one line. */
int pc2_load(struct pool *pool, const char *path, int64_t nv, int room,
             struct clip *clip);

/* Returns the number of triangles with two equal corners or no area in
 * binary64. */
int64_t mesh_degenerate(const struct mesh *mesh);

/* How a mesh is placed in the scene; the steps are applied in this order. */
struct placement {
    double up[3];          /* direction that becomes +y; 0: none */
    double size;           /* m, the largest dimension becomes this; 0: none */
    double scale;          /* factor */
    int stand;             /* 1: least y becomes 0, x and z are centred */
    double axis[3], angle; /* rotation about the axis, degrees */
    double at[3];          /* m, translation */
};
void mesh_place(struct mesh *mesh, const struct placement *placement);
/* Places frames [frames][nv] of a mesh as its first one would be. */
void mesh_place_frames(double (*x)[3], int64_t nv, int64_t frames,
                       const struct placement *placement);

/* The bounding box of the mesh. */
void mesh_box(const struct mesh *mesh, double lo[3], double hi[3]);

/* Readers of one format each. Return app_exit; a failure prints one line. */
int ply_load(struct pool *pool, const char *path, struct mesh *mesh);
int off_load(struct pool *pool, const char *path, struct mesh *mesh);
/* Writes the mesh as PLY to an open stream, which tells of failures. */
void ply_put(FILE *out, const struct mesh *mesh, int bits);
/* Writers of one format each. bits: 32 writes floats, 64 doubles. false after
 * one line. */
bool ply_save(const char *directory, const char *name, const struct mesh *mesh,
              int bits);
bool obj_save(const char *directory, const char *name, const struct mesh *mesh,
              int bits);
/* A body in a mesh of several, for its object in an OBJ file. */
struct part {
    const char *name;
    int64_t nv, nt; /* its vertices and triangles, after those of the part
                       before */
    int m, n; /* particles of a cloth along u and v; 0: an obstacle, which has
                 no UVs */
    const double (*rest)[2]; /* [nv] m, particles of a panel at rest; NULL: the
                                grid has them */
    double size[2];          /* m, of the grid at rest */
};
/* Writes parts as objects by their names, without vertices of no triangle. */
bool obj_save_parts(const char *directory, const char *name,
                    const struct mesh *mesh, const struct part *part, int parts,
                    int bits);

#endif
