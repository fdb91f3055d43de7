/* SPDX-License-Identifier: Apache-2.0 */
/* The tool's readers on any bytes: `scene` a scene file, `mesh` a PLY. They
 * refuse or accept; the sanitizers and limits judge. assimp's readers of other
 * formats are not ours to fuzz. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "app/mesh.h"
#include "app/scene.h"
#include "fuzz/stage.h"

static const char *try_scene(const char *path)
{
    static struct scene scene;
    int status = scene_load(&scene, path);
    bool named = scene.name != NULL;
    scene_free(&scene);
    return status == 0 && !named ? "a scene without a name" : NULL;
}

static const char *try_mesh(const char *path)
{
    struct pool pool = {NULL};
    struct mesh mesh;
    const char *failed = NULL;
    if (mesh_load(&pool, path, &mesh) == 0) {
        double lo[3], hi[3];
        mesh_box(&mesh, lo, hi);
        mesh_degenerate(&mesh);
        if (mesh.nt <= 0)
            failed = "a mesh of nothing was accepted";
        for (int k = 0; k < 3; k++)
            if (!(hi[k] - lo[k] >= 0))
                failed = "a number that is not finite was accepted";
        for (int64_t k = 0; k < 3 * mesh.nt; k++)
            if (mesh.tri[k / 3][k % 3] < 0 || mesh.tri[k / 3][k % 3] >= mesh.nv)
                failed = "an index out of range was accepted";
    }
    pool_free(&pool);
    return failed;
}

const char *fuzz_reader(const char *name, const uint8_t *data, size_t size)
{
    char path[64];
    bool scene = strcmp(name, "scene") == 0;
    if (!scene && strcmp(name, "mesh") != 0)
        return "no such stage";
    snprintf(path, sizeof path, "/tmp/drape-fuzz-%ld.ply", (long)getpid());
    FILE *f = fopen(path, "wb");
    if (!f)
        return "no file can be made in /tmp";
    bool written = fwrite(data, 1, size, f) == size;
    written = fclose(f) == 0 && written;
    const char *failed = !written ? "the disk is full"
                         : scene  ? try_scene(path)
                                  : try_mesh(path);
    remove(path);
    return failed;
}
