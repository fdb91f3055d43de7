/* SPDX-License-Identifier: Apache-2.0 */
/* Where the nodes of a scene are that assimp has read, at a time of one of its
 * animations. For the child process of app/read/import.c. */
#ifndef APP_READ_POSE_H
#define APP_READ_POSE_H

#include <assimp/scene.h>

/* The first three rows of a matrix, by rows. */
typedef double pose_matrix[12];

struct pose_node {
    const struct aiNode *node;
    int parent; /* index into the list; -1: none */
    pose_matrix at;
};
struct pose {
    const struct aiScene *scene;
    const struct aiAnimation
        *clip;              /* NULL: the nodes are as they are at rest */
    double scale;           /* m in a unit of the file */
    struct pose_node *node; /* [n] parents first */
    int n;
};

/* c = a b */
void pose_compose(const pose_matrix a, const pose_matrix b, pose_matrix c);
/* The matrix that assimp has in its own precision. */
void pose_matrix_of(const struct aiMatrix4x4 *m, pose_matrix out);
void pose_apply(const pose_matrix m, const double x[3], double out[3]);

/* Lists the nodes. NULL, or why that cannot be done. */
const char *pose_open(struct pose *pose, const struct aiScene *scene);
/* Sets where the nodes are, s seconds after the animation's start. */
void pose_set(struct pose *pose, double s);
/* The node of this name, or NULL. */
const struct pose_node *pose_find(const struct pose *pose, const char *name);
/* The weights [n] of a mesh's morph targets at that time; the mesh is of this
 * node. */
void pose_weights(const struct pose *pose, double s, const struct aiNode *node,
                  const struct aiMesh *mesh, double *weight);
/* s, how long the animation takes. */
double pose_length(const struct aiAnimation *clip);

#endif
