/* SPDX-License-Identifier: Apache-2.0 */
/* The child process of import.c: reads a file by assimp and sends the mesh to
 * the parent, with the frames of its animation. It may crash, and it never
 * returns. */
#include "app/read/import.h"

#include "app/read/pose.h"

#include <assimp/cimport.h>
#include <assimp/postprocess.h>
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Collects a scene's meshes in one mesh, without lines and points. */
struct gather {
    struct pose pose;
    double time;       /* s of the animation */
    struct mesh *mesh; /* x is NULL: vertices and triangles are counted only */
    int64_t nv, nt;
    const char *wrong; /* the first fault, or NULL */
    double *weight;    /* [most morph targets of a mesh, then most vertices] */
};

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

static void load(const struct aiVector3D *p, double x[3])
{
    x[0] = (double)p->x;
    x[1] = (double)p->y;
    x[2] = (double)p->z;
}

/* The mesh in its own coordinates, moved by its morph targets. */
static void morph(struct gather *g, const struct pose_node *node,
                  const struct aiMesh *from, double (*x)[3])
{
    double at[3];
    for (unsigned k = 0; k < from->mNumVertices; k++)
        load(&from->mVertices[k], x[k]);
    if (from->mNumAnimMeshes)
        pose_weights(&g->pose, g->time, node->node, from, g->weight);
    for (unsigned t = 0; t < from->mNumAnimMeshes; t++) {
        const struct aiAnimMesh *target = from->mAnimMeshes[t];
        double w = g->weight[t];
        if (w == 0 || !target->mVertices ||
            target->mNumVertices != from->mNumVertices)
            continue;
        for (unsigned k = 0; k < from->mNumVertices; k++) {
            load(&target->mVertices[k], at);
            for (int i = 0; i < 3; i++)
                x[k][i] += w * (at[i] - (double)(&from->mVertices[k].x)[i]);
        }
    }
}

/* Adds what a bone does to its vertices to `to`, and its weights to g->weight.
 */
static void bend(struct gather *g, const struct aiBone *bone, unsigned n,
                 double (*x)[3], double (*to)[3])
{
    const struct pose_node *node = pose_find(&g->pose, bone->mName.data);
    pose_matrix offset, m;
    double at[3];
    if (!node) {
        g->wrong = "a bone names a node that is not there";
        return;
    }
    pose_matrix_of(&bone->mOffsetMatrix, offset);
    pose_compose(node->at, offset, m);
    for (unsigned k = 0; k < bone->mNumWeights; k++) {
        unsigned p = bone->mWeights[k].mVertexId;
        double w = (double)bone->mWeights[k].mWeight;
        if (p >= n) {
            g->wrong = "a bone names a vertex that is not there";
            return;
        }
        pose_apply(m, x[p], at);
        for (int i = 0; i < 3; i++)
            to[p][i] += w * at[i];
        g->weight[p] += w;
    }
}

/* Moves the mesh by its bones; what no bone moves goes with the mesh's node. */
static void skin(struct gather *g, const struct pose_node *node,
                 const struct aiMesh *from, double (*x)[3])
{
    unsigned n = from->mNumVertices;
    double(*to)[3] = calloc((size_t)n + 1, sizeof *to);
    if (!to) {
        g->wrong = "std::bad_alloc";
        return;
    }
    memset(g->weight, 0, n * sizeof *g->weight);
    for (unsigned k = 0; k < from->mNumBones && !g->wrong; k++)
        bend(g, from->mBones[k], n, x, to);
    for (unsigned k = 0; k < n; k++) {
        if (!(g->weight[k] > 0))
            pose_apply(node->at, x[k], to[k]);
        for (int i = 0; i < 3; i++)
            x[k][i] = g->weight[k] > 0 ? to[k][i] / g->weight[k] : to[k][i];
    }
    free(to);
}

static void gather_mesh(struct gather *g, const struct pose_node *node,
                        const struct aiMesh *from)
{
    if (g->mesh->x) {
        double(*x)[3] = g->mesh->x + g->nv, at[3];
        morph(g, node, from, x);
        if (from->mNumBones)
            skin(g, node, from, x);
        for (unsigned k = 0; k < from->mNumVertices && !from->mNumBones; k++) {
            pose_apply(node->at, x[k], at);
            memcpy(x[k], at, sizeof at);
        }
    }
    gather_faces(g, from);
    g->nv += from->mNumVertices;
    if (g->nv > INT32_MAX || g->nt > INT32_MAX)
        g->wrong = "more than 2^31 vertices or triangles";
}

/* The meshes at a time of the animation. */
static void gather_all(struct gather *g, double time)
{
    const struct aiScene *scene = g->pose.scene;
    g->nv = g->nt = 0;
    g->time = time;
    pose_set(&g->pose, time);
    for (int k = 0; k < g->pose.n; k++) {
        const struct pose_node *node = &g->pose.node[k];
        for (unsigned i = 0; !g->wrong && i < node->node->mNumMeshes; i++)
            gather_mesh(g, node, scene->mMeshes[node->node->mMeshes[i]]);
    }
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

/* Chooses the animation of this name, or the first if name is NULL, or none if
 * it is empty, and says in `note` which there are. NULL, or why there is none
 * of this name. */
static const char *choose(struct pose *pose, const char *name, char *note,
                          size_t room)
{
    const struct aiScene *scene = pose->scene;
    *note = 0;
    for (unsigned k = 0; k < scene->mNumAnimations; k++) {
        const struct aiAnimation *clip = scene->mAnimations[k];
        size_t length = strlen(note);
        bool right = name ? strcmp(name, clip->mName.data) == 0 : k == 0;
        snprintf(note + length, room - length, "%s\"%.40s\"", k ? ", " : "",
                 clip->mName.data);
        if (right && !pose->clip && !(name && !*name))
            pose->clip = clip;
    }
    if (!name || !*name || pose->clip)
        return NULL;
    return scene->mNumAnimations ? "has no animation of this name"
                                 : "has no animation";
}

/* The largest number of morph targets or vertices of a mesh. */
static size_t most_weights(const struct aiScene *scene)
{
    size_t most = 0;
    for (unsigned k = 0; k < scene->mNumMeshes; k++) {
        const struct aiMesh *m = scene->mMeshes[k];
        size_t n = m->mNumVertices > m->mNumAnimMeshes ? m->mNumVertices
                                                       : m->mNumAnimMeshes;
        most = n > most ? n : most;
    }
    return most;
}

/* Reads the file, and what is chosen of it, up to its sizes. */
static void open_file(struct gather *g, const char *path, const char *clip,
                      struct import_reply *reply, int out)
{
    struct aiLogStream log = {hear, reply->error};
    aiAttachLogStream(&log);
    const struct aiScene *scene = aiImportFile(path, aiProcess_Triangulate);
    if (!scene || !scene->mRootNode)
        send_error(out, aiGetErrorString());
    if (*reply->error)
        send_error(out, reply->error);
    g->wrong = pose_open(&g->pose, scene);
    if (!g->wrong)
        g->wrong = choose(&g->pose, clip, reply->clips, sizeof reply->clips);
    if (!g->wrong)
        gather_all(g, 0);
    g->weight = calloc(most_weights(scene) + 1, sizeof *g->weight);
    if (!g->weight)
        g->wrong = "std::bad_alloc";
    double s = g->pose.clip ? pose_length(g->pose.clip) : 0;
    if (s * IMPORT_RATE >= IMPORT_FRAMES)
        g->wrong = "its animation takes too long";
    else if (s > 0)
        reply->frames = 1 + (int64_t)ceil(s * IMPORT_RATE);
    if (g->wrong)
        send_error(out, g->wrong);
    reply->nv = g->nv;
    reply->nt = g->nt;
    reply->several = scene->mNumAnimations > 1 && !clip;
}

_Noreturn void import_child(const char *path, const char *clip, int out)
{
    struct import_reply reply = {.magic = IMPORT_MAGIC};
    struct mesh mesh = {0};
    struct gather g = {.mesh = &mesh};
    open_file(&g, path, clip, &reply, out);
    mesh.x = calloc((size_t)g.nv + 1, sizeof *mesh.x);
    mesh.tri = calloc((size_t)g.nt + 1, sizeof *mesh.tri);
    if (!mesh.x || !mesh.tri)
        send_error(out, "std::bad_alloc");
    gather_all(&g, 0);
    if (g.wrong)
        send_error(out, g.wrong);
    put(out, &reply, sizeof reply);
    put(out, mesh.x, (size_t)g.nv * sizeof *mesh.x);
    put(out, mesh.tri, (size_t)g.nt * sizeof *mesh.tri);
    for (int64_t k = 0; k < reply.frames; k++) {
        gather_all(&g, (double)k / IMPORT_RATE);
        put(out, mesh.x, (size_t)g.nv * sizeof *mesh.x);
    }
    _exit(0);
}
