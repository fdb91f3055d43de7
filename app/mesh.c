/* SPDX-License-Identifier: Apache-2.0 */
/* Meshes from files through assimp, and laid in place. */
#include "app/mesh.h"
#include "app/app.h"
#include "app/file.h"
#include "app/shapes.h"

#include <assimp/cimport.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Where a scene's meshes gather; lines and points are left out. */
struct gather {
    const struct aiScene *scene;
    struct mesh *mesh; /* NULL x: only counting */
    int64_t nv, nt;
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
    for (unsigned k = 0; k < from->mNumFaces; k++) {
        const struct aiFace *face = &from->mFaces[k];
        if (face->mNumIndices != 3)
            continue;
        for (int i = 0; mesh->tri && i < 3; i++)
            mesh->tri[g->nt][i] = (int32_t)(g->nv + face->mIndices[i]);
        g->nt++;
    }
    g->nv += from->mNumVertices;
}

static void gather_node(struct gather *g, const struct aiNode *node,
                        const double parent[12], int depth)
{
    double matrix[12];
    compose(parent, &node->mTransformation, matrix);
    for (unsigned k = 0; k < node->mNumMeshes; k++)
        gather_mesh(g, g->scene->mMeshes[node->mMeshes[k]], matrix);
    for (unsigned k = 0; depth < 256 && k < node->mNumChildren; k++)
        gather_node(g, node->mChildren[k], matrix, depth + 1);
}

static void gather_all(struct gather *g)
{
    static const double one[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
    g->nv = g->nt = 0;
    gather_node(g, g->scene->mRootNode, one, 0);
}

/* For qsort: by position, then by number so that the first one leads. */
static int by_position(const void *a, const void *b)
{
    const double *p = a, *q = b;
    for (int k = 0; k < 4; k++)
        if (p[k] != q[k])
            return p[k] < q[k] ? -1 : 1;
    return 0;
}

/* Vertices at exactly the same place become one, and unused ones go: assimp
 * gives most formats three vertices a triangle. (Its own joining step takes
 * all within 1e-5 m for one, too coarse for cloth.) */
static int weld(struct mesh *mesh)
{
    size_t nv = (size_t)mesh->nv;
    if (!nv || !mesh->x)
        return APP_OK;
    double(*key)[4] = calloc(nv, sizeof *key);
    int32_t *leader = calloc(nv, sizeof *leader);
    if (!key || !leader) {
        free(key);
        free(leader);
        return complain(APP_FAILED, "out of memory");
    }
    for (size_t k = 0; k < nv; k++) {
        memcpy(key[k], mesh->x[k], sizeof mesh->x[k]);
        key[k][3] = (double)k;
    }
    qsort(key, nv, sizeof *key, by_position);
    for (size_t k = 0, first = 0; k < nv; k++) {
        if (memcmp(key[k], key[first], 3 * sizeof(double)) != 0 &&
            (key[k][0] != key[first][0] || key[k][1] != key[first][1] ||
             key[k][2] != key[first][2]))
            first = k;
        leader[(size_t)key[k][3]] = (int32_t)key[first][3];
    }
    int32_t used = 0;
    for (size_t k = 0; k < nv; k++) {
        if (leader[k] != (int32_t)k) {
            leader[k] = leader[leader[k]];
            continue;
        }
        memcpy(mesh->x[used], mesh->x[k], sizeof mesh->x[k]);
        leader[k] = used++;
    }
    for (int64_t k = 0; k < mesh->nt; k++)
        for (int i = 0; i < 3; i++)
            mesh->tri[k][i] = leader[mesh->tri[k][i]];
    mesh->nv = used;
    free(key);
    free(leader);
    return APP_OK;
}

static int load_assimp(struct pool *pool, const char *path, struct mesh *mesh)
{
    const struct aiScene *scene = aiImportFile(path, aiProcess_Triangulate);
    if (!scene || !scene->mRootNode) {
        const char *why = aiGetErrorString();
        int line = (int)strcspn(why, "\n");
        complain(APP_USAGE, "%s: cannot be read as a mesh: %.*s", path, line,
                 why);
        aiReleaseImport(scene);
        return APP_USAGE;
    }
    struct gather g = {.scene = scene, .mesh = mesh};
    gather_all(&g);
    int status = APP_OK;
    if (g.nv > INT32_MAX || g.nt > INT32_MAX) {
        status = complain(APP_USAGE, "%s: more than 2^31 vertices", path);
    } else {
        mesh->nv = g.nv;
        mesh->nt = g.nt;
        mesh->x = pool_take(pool, (size_t)g.nv + 1, sizeof *mesh->x);
        mesh->tri = pool_take(pool, (size_t)g.nt + 1, sizeof *mesh->tri);
        if (mesh->x && mesh->tri)
            gather_all(&g);
        else
            status = complain(APP_FAILED, "%s: out of memory", path);
    }
    aiReleaseImport(scene);
    return status;
}

/* What every mesh must be, whoever read it. */
static int check(const char *path, const struct mesh *mesh)
{
    if (mesh->nv == 0 || mesh->nt == 0)
        return complain(APP_USAGE, "%s: no triangles; expected at least one",
                        path);
    for (int64_t k = 0; k < mesh->nv; k++)
        for (int i = 0; i < 3; i++)
            if (!(fabs(mesh->x[k][i]) <= 0x1p60))
                return complain(APP_USAGE,
                                "%s: vertex %lld: a coordinate is not finite "
                                "or beyond 2^60",
                                path, (long long)k);
    for (int64_t k = 0; k < mesh->nt; k++)
        for (int i = 0; i < 3; i++)
            if (mesh->tri[k][i] < 0 || mesh->tri[k][i] >= mesh->nv)
                return complain(APP_USAGE,
                                "%s: triangle %lld: vertex %d is not among "
                                "the %lld",
                                path, (long long)k, (int)mesh->tri[k][i],
                                (long long)mesh->nv);
    return APP_OK;
}

static bool ends_with_ply(const char *path)
{
    size_t n = strlen(path);
    return n > 4 && path[n - 4] == '.' && tolower(path[n - 3]) == 'p' &&
           tolower(path[n - 2]) == 'l' && tolower(path[n - 1]) == 'y';
}

int mesh_load(struct pool *pool, const char *path, struct mesh *mesh)
{
    memset(mesh, 0, sizeof *mesh);
    if (!file_exists(path) || file_is_directory(path))
        return complain(APP_USAGE, "%s: no such mesh file", path);
    if (ends_with_ply(path)) {
        int status = ply_load(pool, path, mesh);
        return status == APP_OK ? check(path, mesh) : status;
    }
    int status = load_assimp(pool, path, mesh);
    if (status == APP_OK)
        status = check(path, mesh);
    return status == APP_OK ? weld(mesh) : status;
}

int64_t mesh_degenerate(const struct mesh *mesh)
{
    int64_t count = 0;
    for (int64_t k = 0; k < mesh->nt; k++) {
        const int32_t *t = mesh->tri[k];
        const double *a = mesh->x[t[0]], *b = mesh->x[t[1]];
        const double *c = mesh->x[t[2]];
        double n[3];
        for (int i = 0; i < 3; i++) {
            int j = (i + 1) % 3, l = (i + 2) % 3;
            n[i] =
                (b[j] - a[j]) * (c[l] - a[l]) - (b[l] - a[l]) * (c[j] - a[j]);
        }
        count += n[0] == 0 && n[1] == 0 && n[2] == 0;
    }
    return count;
}

void mesh_box(const struct mesh *mesh, double lo[3], double hi[3])
{
    for (int i = 0; i < 3; i++)
        lo[i] = hi[i] = mesh->nv ? mesh->x[0][i] : 0;
    for (int64_t k = 0; k < mesh->nv; k++)
        for (int i = 0; i < 3; i++) {
            lo[i] = fmin(lo[i], mesh->x[k][i]);
            hi[i] = fmax(hi[i], mesh->x[k][i]);
        }
}
