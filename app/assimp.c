/* SPDX-License-Identifier: Apache-2.0 */
/* The child process of import.c: reads a file by assimp and sends the mesh to
 * the parent. It may crash, and it never returns. */
#include "app/import.h"

#include <assimp/cimport.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Collects a scene's meshes in one mesh, without lines and points. */
struct gather {
    const struct aiScene *scene;
    struct mesh *mesh; /* x is NULL: vertices and triangles are counted only */
    int64_t nv, nt;
    const char *wrong; /* the first fault, or NULL */
};

/* Node matrices are composed in binary64, parents first. */
static void compose(const double parent[12], const struct aiMatrix4x4 *m,
                    double out[12])
{
    const ai_real *row[3] = {&m->a1, &m->b1, &m->c1};
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 4; j++) {
            double sum = j == 3 ? parent[4 * i + 3] : 0;
            for (int k = 0; k < 3; k++)
                sum += parent[4 * i + k] * (double)row[k][j];
            out[4 * i + j] = sum;
        }
}

static void gather_faces(struct gather *g, const struct aiMesh *from)
{
    struct mesh *mesh = g->mesh;
    for (unsigned k = 0; k < from->mNumFaces; k++) {
        const struct aiFace *face = &from->mFaces[k];
        if (face->mNumIndices != 3)
            continue;
        for (int i = 0; i < 3; i++) {
            /* an index beyond this mesh would name a vertex of the next mesh */
            if (face->mIndices[i] >= from->mNumVertices)
                g->wrong = "a face names a vertex that is not there";
            if (mesh->tri)
                mesh->tri[g->nt][i] = (int32_t)(g->nv + face->mIndices[i]);
        }
        g->nt++;
    }
}

static void gather_mesh(struct gather *g, const struct aiMesh *from,
                        const double matrix[12])
{
    struct mesh *mesh = g->mesh;
    for (unsigned k = 0; mesh->x && k < from->mNumVertices; k++) {
        const struct aiVector3D *p = &from->mVertices[k];
        for (int i = 0; i < 3; i++)
            mesh->x[g->nv + k][i] = matrix[4 * i] * (double)p->x +
                                    matrix[4 * i + 1] * (double)p->y +
                                    matrix[4 * i + 2] * (double)p->z +
                                    matrix[4 * i + 3];
    }
    gather_faces(g, from);
    g->nv += from->mNumVertices;
    if (g->nv > INT32_MAX || g->nt > INT32_MAX)
        g->wrong = "more than 2^31 vertices or triangles";
}

static void gather_node(struct gather *g, const struct aiNode *node,
                        const double parent[12], int depth)
{
    double matrix[12];
    compose(parent, &node->mTransformation, matrix);
    for (unsigned k = 0; !g->wrong && k < node->mNumMeshes; k++)
        gather_mesh(g, g->scene->mMeshes[node->mMeshes[k]], matrix);
    if (depth == 256 && node->mNumChildren)
        g->wrong = "its nodes lie in more than 256 others";
    for (unsigned k = 0; !g->wrong && k < node->mNumChildren; k++)
        gather_node(g, node->mChildren[k], matrix, depth + 1);
}

static void gather_all(struct gather *g)
{
    static const double one[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
    g->nv = g->nt = 0;
    gather_node(g, g->scene->mRootNode, one, 0);
}

/* Sends bytes to the parent; ends the child if the parent reads no more. */
static void put(int out, const void *data, size_t size)
{
    const char *at = data;
    while (size) {
        ssize_t sent = write(out, at, size);
        if (sent < 0 && errno == EINTR)
            continue;
        if (sent <= 0)
            _exit(1);
        at += sent;
        size -= (size_t)sent;
    }
}

_Noreturn static void send_error(int out, const char *why)
{
    struct import_reply reply = {.magic = IMPORT_MAGIC};
    int line = (int)strcspn(why, "\n");
    snprintf(reply.error, sizeof reply.error, "%.*s", line,
             line ? why : "no reason given");
    put(out, &reply, sizeof reply);
    _exit(0);
}

/* A log callback of assimp: keeps its message about faces that it drops, such
 * as those of glTF with wrong indices. */
static void hear(const char *message, char *dropped)
{
    const char *text = strstr(message, ": ");
    if (strstr(message, "out of range") || strstr(message, "out-of-range"))
        snprintf(dropped, sizeof((struct import_reply *)0)->error, "%s",
                 text ? text + 2 : message);
}

_Noreturn void import_child(const char *path, int out)
{
    struct import_reply reply = {.magic = IMPORT_MAGIC};
    struct aiLogStream log = {hear, reply.error};
    aiAttachLogStream(&log);
    const struct aiScene *scene = aiImportFile(path, aiProcess_Triangulate);
    if (!scene || !scene->mRootNode)
        send_error(out, aiGetErrorString());
    if (*reply.error)
        send_error(out, reply.error);
    struct mesh mesh = {0};
    struct gather g = {.scene = scene, .mesh = &mesh};
    gather_all(&g);
    if (g.wrong)
        send_error(out, g.wrong);
    reply.nv = g.nv;
    reply.nt = g.nt;
    mesh.x = calloc((size_t)g.nv + 1, sizeof *mesh.x);
    mesh.tri = calloc((size_t)g.nt + 1, sizeof *mesh.tri);
    if (!mesh.x || !mesh.tri)
        send_error(out, "std::bad_alloc");
    gather_all(&g);
    put(out, &reply, sizeof reply);
    put(out, mesh.x, (size_t)g.nv * sizeof *mesh.x);
    put(out, mesh.tri, (size_t)g.nt * sizeof *mesh.tri);
    _exit(0);
}
