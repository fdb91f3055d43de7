/* SPDX-License-Identifier: Apache-2.0 */
/* Reads mesh files of all known formats and checks the meshes. */
#include "app/read/mesh.h"
#include "app/base/app.h"
#include "app/base/file.h"
#include "app/read/import.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

/* A vertex, where it is in each frame: number `at` of rows of nv. */
struct spot {
    const struct trail {
        const double (*x)[3];
        int64_t nv, frames;
    } * of;
    int64_t at;
};

/* Orders by position in the first frame in which they differ; 0: in none. */
static int by_place(const struct spot *a, const struct spot *b)
{
    for (int64_t f = 0; f < a->of->frames; f++) {
        const double *p = a->of->x[f * a->of->nv + a->at];
        const double *q = b->of->x[f * b->of->nv + b->at];
        for (int k = 0; k < 3; k++)
            if (p[k] != q[k])
                return p[k] < q[k] ? -1 : 1;
    }
    return 0;
}

/* For qsort: orders by position, then by index. */
static int by_position(const void *a, const void *b)
{
    const struct spot *p = a, *q = b;
    int order = by_place(p, q);
    return order ? order : p->at < q->at ? -1 : 1;
}

/* Finds for each vertex the first at the same place in all frames. */
static void find_leaders(const struct trail *trail, struct spot *spot,
                         int32_t *leader)
{
    size_t nv = (size_t)trail->nv, first = 0;
    for (size_t k = 0; k < nv; k++)
        spot[k] = (struct spot){trail, (int64_t)k};
    qsort(spot, nv, sizeof *spot, by_position);
    for (size_t k = 0; k < nv; k++) {
        if (by_place(&spot[k], &spot[first]) != 0)
            first = k;
        leader[spot[k].at] = (int32_t)spot[first].at;
    }
}

/* Keeps the leaders of each of `rows` rows of nv vertices. */
static void keep_leaders(double (*x)[3], int64_t rows, int64_t nv,
                         const int32_t *leader)
{
    int64_t used = 0;
    for (int64_t k = 0; k < rows * nv; k++)
        if (leader[k % nv] == k % nv)
            memmove(x[used++], x[k], sizeof *x);
}

/* Merges vertices at exactly the same place and removes unused vertices, since
 * for most formats assimp returns three vertices for each triangle. assimp's
 * own joining step merges all vertices within 1e-5 m, which is too coarse here.
 */
static int weld(struct mesh *mesh, struct clip *clip)
{
    struct trail trail = {(const double(*)[3])mesh->x, mesh->nv, 1};
    if (clip && clip->frames)
        trail =
            (struct trail){(const double(*)[3])clip->x, mesh->nv, clip->frames};
    size_t nv = (size_t)mesh->nv;
    if (!nv || !mesh->x)
        return APP_OK;
    struct spot *spot = calloc(nv, sizeof *spot);
    int32_t *leader = calloc(nv, sizeof *leader), *to = calloc(nv, sizeof *to);
    if (spot && leader && to) {
        int32_t used = 0;
        find_leaders(&trail, spot, leader);
        for (size_t k = 0; k < nv; k++)
            to[k] = leader[k] == (int32_t)k ? used++ : to[leader[k]];
        if (clip && clip->frames)
            keep_leaders(clip->x, clip->frames, mesh->nv, leader);
        keep_leaders(mesh->x, 1, mesh->nv, leader);
        for (int64_t k = 0; k < 3 * mesh->nt; k++)
            mesh->tri[k / 3][k % 3] = to[mesh->tri[k / 3][k % 3]];
        mesh->nv = used;
    }
    bool good = spot && leader && to;
    free(spot);
    free(leader);
    free(to);
    return good ? APP_OK : complain(APP_FAILED, "out of memory");
}

/* Whether a frame has another vertex elsewhere than the first. */
static bool moves(const struct mesh *mesh, const struct clip *clip)
{
    size_t row = (size_t)mesh->nv * sizeof *clip->x;
    for (int k = 1; k < clip->frames; k++)
        if (memcmp(clip->x + (size_t)k * (size_t)mesh->nv, clip->x, row) != 0)
            return true;
    return false;
}

/* Checks that n positions are numbers that the library takes. */
static int check_places(const char *path, int64_t n, double (*x)[3], int64_t nv)
{
    for (int64_t k = 0; k < n; k++)
        for (int i = 0; i < 3; i++)
            if (!(fabs(x[k][i]) <= 0x1p60))
                return complain(APP_USAGE,
                                "%s: vertex %lld: a coordinate is not finite "
                                "or beyond 2^60",
                                path, (long long)(k % nv));
    return APP_OK;
}

/* Checks that a mesh is valid, whichever reader it comes from. */
static int check(const char *path, const struct mesh *mesh,
                 const struct clip *clip)
{
    if (mesh->nv == 0 || mesh->nt == 0)
        return complain(APP_USAGE, "%s: no triangles; expected at least one",
                        path);
    int status = check_places(path, mesh->nv, mesh->x, mesh->nv);
    if (status == APP_OK && clip)
        status = check_places(path, clip->frames * mesh->nv, clip->x, mesh->nv);
    if (status != APP_OK)
        return status;
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

/* Reads a file of any known format and checks it. */
static int read_file(struct pool *pool, const char *path, struct clip *clip,
                     struct mesh *mesh)
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
                        "%s: the Python package reads USD (read_meshes), the "
                        "tool does not; save the mesh as .glb, .obj or .ply",
                        path);
    if (!ply && !off && !import_knows(path))
        return complain(APP_USAGE,
                        "%s: expected a mesh file that ends in .ply, .off, "
                        ".obj, .stl, .gltf, .glb, .dae or .fbx",
                        path);
    int status = ply   ? ply_load(pool, path, mesh)
                 : off ? off_load(pool, path, mesh)
                       : import_load(pool, path, clip, mesh);
    if (status == APP_OK)
        status = check(path, mesh, clip);
    if (status == APP_OK && clip && clip->name && *clip->name && (ply || off))
        status = complain(APP_USAGE, "%s: has no animation", path);
    if (status == APP_OK && clip && clip->frames && !moves(mesh, clip)) {
        complain(APP_OK, "%s: its animation moves no triangle", path);
        clip->frames = 0;
    }
    return status;
}

int mesh_load(struct pool *pool, const char *path, struct mesh *mesh)
{
    return mesh_load_clip(pool, path, NULL, mesh);
}

int mesh_load_plain(struct pool *pool, const char *path, struct mesh *mesh)
{
    return read_file(pool, path, NULL, mesh);
}

int mesh_load_clip(struct pool *pool, const char *path, struct clip *clip,
                   struct mesh *mesh)
{
    int status = read_file(pool, path, clip, mesh);
    return status == APP_OK ? mesh_merge(path, mesh, clip) : status;
}

int mesh_merge(const char *path, struct mesh *mesh, struct clip *clip)
{
    return ends_with(path, "ply") ? APP_OK : weld(mesh, clip);
}

bool mesh_ordered(const char *path)
{
    return ends_with(path, "ply") || ends_with(path, "off");
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
