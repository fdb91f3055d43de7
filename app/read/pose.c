/* SPDX-License-Identifier: Apache-2.0 */
/* Nodes of a scene at a time of an animation; see app/read/pose.h. Keys are
 * joined by straight lines, rotations by arcs, as glTF's LINEAR says. No
 * function of libm whose last bit depends on the machine is called. */
#include "app/read/pose.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

enum { DEEPEST = 256, HALVINGS = 40 };

void pose_compose(const pose_matrix a, const pose_matrix b, pose_matrix c)
{
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 4; j++) {
            double sum = j == 3 ? a[4 * i + 3] : 0;
            for (int k = 0; k < 3; k++)
                sum += a[4 * i + k] * b[4 * k + j];
            c[4 * i + j] = sum;
        }
}

void pose_matrix_of(const struct aiMatrix4x4 *m, pose_matrix out)
{
    const ai_real *row[3] = {&m->a1, &m->b1, &m->c1};
    for (int i = 0; i < 12; i++)
        out[i] = (double)row[i / 4][i % 4];
}

void pose_apply(const pose_matrix m, const double x[3], double out[3])
{
    for (int i = 0; i < 3; i++)
        out[i] = m[4 * i] * x[0] + m[4 * i + 1] * x[1] + m[4 * i + 2] * x[2] +
                 m[4 * i + 3];
}

static const char *list(struct pose *pose, const struct aiNode *node,
                        int parent, int depth)
{
    if (depth > DEEPEST)
        return "its nodes lie in more than 256 others";
    void *more =
        realloc(pose->node, (size_t)(pose->n + 1) * sizeof *pose->node);
    if (!more)
        return "std::bad_alloc";
    pose->node = more;
    int here = pose->n++;
    pose->node[here] = (struct pose_node){.node = node, .parent = parent};
    const char *wrong = NULL;
    for (unsigned k = 0; k < node->mNumChildren && !wrong; k++)
        wrong = list(pose, node->mChildren[k], here, depth + 1);
    return wrong;
}

/* Metres in a unit of the file: FBX says how many centimetres that are. */
static double unit_of(const struct aiScene *scene)
{
    const struct aiMetadata *data = scene->mMetaData;
    double scale = 100;
    for (unsigned k = 0; data && k < data->mNumProperties; k++) {
        const struct aiMetadataEntry *entry = &data->mValues[k];
        if (strcmp(data->mKeys[k].data, "UnitScaleFactor") != 0)
            continue;
        float single = 0;
        if (entry->mType == AI_DOUBLE)
            memcpy(&scale, entry->mData, sizeof scale);
        if (entry->mType == AI_FLOAT) {
            memcpy(&single, entry->mData, sizeof single);
            scale = (double)single;
        }
    }
    return scale > 0 && scale < INFINITY ? scale / 100 : 1;
}

const char *pose_open(struct pose *pose, const struct aiScene *scene)
{
    *pose = (struct pose){.scene = scene, .scale = unit_of(scene)};
    return list(pose, scene->mRootNode, -1, 0);
}

double pose_length(const struct aiAnimation *clip)
{
    double ticks = clip->mTicksPerSecond;
    double s = clip->mDuration / (ticks > 0 ? ticks : 25);
    return s > 0 ? s : 0;
}

static double ticks_of(const struct pose *pose, double s)
{
    double ticks = pose->clip->mTicksPerSecond;
    return s * (ticks > 0 ? ticks : 25);
}

/* The last of n keys that is not behind tick t, else the first; *part: how far
 * t is to the next, 0 … 1. tick: the first key's, and those of the others
 * follow `size` bytes apart. */
static unsigned key_at(const double *tick, size_t size, unsigned n, double t,
                       double *part)
{
    const char *at = (const char *)tick;
    double here = *tick, next = here;
    unsigned k = 0;
    for (; k + 1 < n; k++) {
        next = *(const double *)(at + (k + 1) * size);
        if (!(next <= t))
            break;
        here = next;
    }
    *part = k + 1 < n && t > here ? (t - here) / (next - here) : 0;
    return k;
}

static void vector_at(const struct aiVectorKey *key, unsigned n, double t,
                      double out[3])
{
    double part;
    unsigned k = key_at(&key->mTime, sizeof *key, n, t, &part);
    const struct aiVector3D *a = &key[k].mValue;
    const struct aiVector3D *b = &key[part > 0 ? k + 1 : k].mValue;
    const double from[3] = {(double)a->x, (double)a->y, (double)a->z};
    const double to[3] = {(double)b->x, (double)b->y, (double)b->z};
    for (int i = 0; i < 3; i++)
        out[i] = from[i] + part * (to[i] - from[i]);
}

static void unit(double q[4])
{
    double square = 0;
    for (int i = 0; i < 4; i++)
        square += q[i] * q[i];
    for (int i = 0; i < 4; i++)
        q[i] = square > 0 ? q[i] / sqrt(square) : (i == 0);
}

/* The rotation at this part of the shorter arc from a to b, by halving the arc:
 * the middle of two unit quaternions is their normalised sum. */
static void turn(double a[4], double b[4], double part, double q[4])
{
    double along = 0;
    unit(a);
    unit(b);
    for (int i = 0; i < 4; i++)
        along += a[i] * b[i];
    for (int i = 0; i < 4 && along < 0; i++)
        b[i] = -b[i];
    for (int k = 0; k < HALVINGS; k++) {
        for (int i = 0; i < 4; i++)
            q[i] = a[i] + b[i];
        unit(q);
        memcpy(part < 0.5 ? b : a, q, 4 * sizeof *q);
        part = part < 0.5 ? 2 * part : 2 * part - 1;
    }
    memcpy(q, a, 4 * sizeof *q);
}

static void rotation_at(const struct aiQuatKey *key, unsigned n, double t,
                        double q[4])
{
    double part;
    unsigned k = key_at(&key->mTime, sizeof *key, n, t, &part);
    const struct aiQuaternion *a = &key[k].mValue;
    const struct aiQuaternion *b = &key[part > 0 ? k + 1 : k].mValue;
    double from[4] = {(double)a->w, (double)a->x, (double)a->y, (double)a->z};
    double to[4] = {(double)b->w, (double)b->x, (double)b->y, (double)b->z};
    turn(from, to, part, q);
}

/* The matrix of translation p, rotation q and scales s. */
static void place(const double p[3], const double q[4], const double s[3],
                  pose_matrix m)
{
    double w = q[0], x = q[1], y = q[2], z = q[3];
    const double r[9] = {1 - 2 * (y * y + z * z), 2 * (x * y - w * z),
                         2 * (x * z + w * y),     2 * (x * y + w * z),
                         1 - 2 * (x * x + z * z), 2 * (y * z - w * x),
                         2 * (x * z - w * y),     2 * (y * z + w * x),
                         1 - 2 * (x * x + y * y)};
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++)
            m[4 * i + j] = r[3 * i + j] * s[j];
        m[4 * i + 3] = p[i];
    }
}

/* The node's own matrix at tick t: of its channel, if it has one. */
static void own(const struct pose *pose, const struct aiNode *node, double t,
                pose_matrix m)
{
    const struct aiAnimation *clip = pose->clip;
    for (unsigned k = 0; clip && k < clip->mNumChannels; k++) {
        const struct aiNodeAnim *channel = clip->mChannels[k];
        double p[3] = {0, 0, 0}, q[4] = {1, 0, 0, 0}, s[3] = {1, 1, 1};
        if (strcmp(channel->mNodeName.data, node->mName.data) != 0)
            continue;
        if (channel->mNumPositionKeys)
            vector_at(channel->mPositionKeys, channel->mNumPositionKeys, t, p);
        if (channel->mNumRotationKeys)
            rotation_at(channel->mRotationKeys, channel->mNumRotationKeys, t,
                        q);
        if (channel->mNumScalingKeys)
            vector_at(channel->mScalingKeys, channel->mNumScalingKeys, t, s);
        place(p, q, s, m);
        return;
    }
    pose_matrix_of(&node->mTransformation, m);
}

void pose_set(struct pose *pose, double s)
{
    const double u = pose->scale;
    const pose_matrix root = {u, 0, 0, 0, 0, u, 0, 0, 0, 0, u, 0};
    double t = pose->clip ? ticks_of(pose, s) : 0;
    for (int k = 0; k < pose->n; k++) {
        struct pose_node *at = &pose->node[k];
        pose_matrix m;
        own(pose, at->node, t, m);
        pose_compose(at->parent < 0 ? root : pose->node[at->parent].at, m,
                     at->at);
    }
}

const struct pose_node *pose_find(const struct pose *pose, const char *name)
{
    for (int k = 0; k < pose->n; k++)
        if (strcmp(pose->node[k].node->mName.data, name) == 0)
            return &pose->node[k];
    return NULL;
}

/* Whether a channel is of this mesh: glTF names the node, FBX the mesh, with a
 * star and a number behind it. */
static bool moves(const struct aiMeshMorphAnim *channel,
                  const struct aiNode *node, const struct aiMesh *mesh)
{
    const char *name = channel->mName.data;
    size_t length = strlen(mesh->mName.data);
    return strcmp(name, node->mName.data) == 0 ||
           (length > 0 && strncmp(name, mesh->mName.data, length) == 0 &&
            (!name[length] || name[length] == '*'));
}

void pose_weights(const struct pose *pose, double s, const struct aiNode *node,
                  const struct aiMesh *mesh, double *weight)
{
    const struct aiAnimation *clip = pose->clip;
    unsigned n = mesh->mNumAnimMeshes;
    for (unsigned k = 0; k < n; k++)
        weight[k] = (double)mesh->mAnimMeshes[k]->mWeight;
    for (unsigned c = 0; clip && c < clip->mNumMorphMeshChannels; c++) {
        const struct aiMeshMorphAnim *channel = clip->mMorphMeshChannels[c];
        const struct aiMeshMorphKey *key = channel->mKeys;
        double part;
        if (!moves(channel, node, mesh) || !channel->mNumKeys)
            continue;
        unsigned k = key_at(&key->mTime, sizeof *key, channel->mNumKeys,
                            ticks_of(pose, s), &part);
        memset(weight, 0, n * sizeof *weight);
        for (unsigned e = 0; e < (part > 0 ? 2u : 1u); e++)
            for (unsigned i = 0; i < key[k + e].mNumValuesAndWeights; i++)
                if (key[k + e].mValues[i] < n)
                    weight[key[k + e].mValues[i]] +=
                        (e ? part : 1 - part) * key[k + e].mWeights[i];
        return;
    }
}
