/* SPDX-License-Identifier: Apache-2.0 */
/* Reads mesh files of all known formats and checks the meshes. */
#include "app/mesh.h"
#include "app/app.h"
#include "app/file.h"
#include "app/import.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

/* For qsort: orders by position, then by index. */
static int by_position(const void *a, const void *b)
{
    const double *p = a, *q = b;
    for (int k = 0; k < 4; k++)
        if (p[k] != q[k])
            return p[k] < q[k] ? -1 : 1;
    return 0;
}

/* Merges vertices at exactly the same place and removes unused vertices, since
 * for most formats assimp returns three vertices for each triangle. assimp's
 * own joining step merges all vertices within 1e-5 m, which is too coarse here.
 */
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

/* Checks that a mesh is valid, whichever reader it comes from. */
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

static bool ends_with(const char *path, const char *ending)
{
    const char *dot = strrchr(path, '.');
    return dot && strcasecmp(dot + 1, ending) == 0;
}

int mesh_load(struct pool *pool, const char *path, struct mesh *mesh)
{
    memset(mesh, 0, sizeof *mesh);
    if (!file_exists(path) || file_is_directory(path))
        return complain(APP_USAGE, "%s: no such mesh file", path);
    if (!file_is_regular(path))
        return complain(APP_USAGE, "%s: is a device or a pipe; expected a file",
                        path);
    bool ply = ends_with(path, "ply"), off = ends_with(path, "off");
    if (ends_with(path, "usd") || ends_with(path, "usda") ||
        ends_with(path, "usdc") || ends_with(path, "usdz"))
        return complain(APP_USAGE,
                        "%s: drape cannot read USD yet (spec/limits.md); save "
                        "the mesh as .glb, .obj or .ply",
                        path);
    if (!ply && !off && !import_knows(path))
        return complain(APP_USAGE,
                        "%s: expected a mesh file that ends in .ply, .off, "
                        ".obj, .stl, .gltf, .glb, .dae or .fbx",
                        path);
    int status = ply   ? ply_load(pool, path, mesh)
                 : off ? off_load(pool, path, mesh)
                       : import_load(pool, path, mesh);
    if (status == APP_OK)
        status = check(path, mesh);
    return status == APP_OK && !ply ? weld(mesh) : status;
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
