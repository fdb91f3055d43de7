/* SPDX-License-Identifier: Apache-2.0 */
/* Temporary files for the targets of the tool's readers. */
#include "fuzz/files.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "app/base/app.h"

static char folder[64];
static long owner; /* process that made the folder; a child process does not
                      remove it */

/* All files that targets make, so that none is left behind. */
static const char *const names[] = {
    "scene.json",    "ball.ply",    "wave_0.ply",
    "wave_1.ply",    "wave_2.ply",  "queries.csv",
    "answers",       "report.json", "checkpoint.drape",
    "in.ply",        "in.off",      "in.obj",
    "in.stl",        "in.gltf",     "in.glb",
    "in.dae",        "in.fbx",      "frames/cloth_0000.ply",
    "settings.json", "pattern.json"};

static void clean(void)
{
    char path[FILES_PATH];
    if (owner != (long)getpid())
        return;
    for (size_t k = 0; k < sizeof names / sizeof *names; k++)
        remove(files_path(names[k], path));
    rmdir(files_path("frames", path));
    rmdir(folder);
}

static const char tetrahedron[] =
    "ply\nformat ascii 1.0\nelement vertex 4\nproperty double x\n"
    "property double y\nproperty double z\nelement face 4\n"
    "property list uchar int vertex_indices\nend_header\n"
    "0 0 0\n.1 0 0\n0 .1 0\n0 0 .1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";

/* Makes the folder on a memory disk if there is one, because the tool
 * synchronises files. */
static void begin(void)
{
    char path[FILES_PATH];
    const char *disk = access("/dev/shm", W_OK) == 0 ? "/dev/shm" : "/tmp";
    snprintf(folder, sizeof folder, "%s/drape-fuzz-XXXXXX", disk);
    if (!mkdtemp(folder))
        abort();
    owner = (long)getpid();
    atexit(clean);
    mkdir(files_path("frames", path), 0777);
    for (int k = 0; k < 3; k++)
        files_write(names[1 + k], tetrahedron, strlen(tetrahedron));
    files_write("frames/cloth_0000.ply", tetrahedron, strlen(tetrahedron));
}

const char *files_path(const char *name, char path[FILES_PATH])
{
    if (!folder[0])
        begin();
    snprintf(path, FILES_PATH, "%s/%s", folder, name);
    return path;
}

void files_write(const char *name, const void *data, size_t size)
{
    char path[FILES_PATH];
    FILE *f = fopen(files_path(name, path), "wb");
    if (!f || (size && fwrite(data, 1, size, f) != size) || fclose(f) != 0)
        abort();
}

char *files_read(const char *name, size_t *size)
{
    char path[FILES_PATH], *text = NULL;
    FILE *f = fopen(files_path(name, path), "rb");
    if (f && fseek(f, 0, SEEK_END) == 0 && ftell(f) >= 0) {
        *size = (size_t)ftell(f);
        text = calloc(*size + 1, 1);
        rewind(f);
        if (text && fread(text, 1, *size, f) != *size)
            abort();
    }
    if (f)
        fclose(f);
    return text;
}

static const char plain[] =
    "{\"name\": \"plain\", \"memory\": 0.1, \"cloths\": [{\"particles\": "
    "[4, 4], \"size\": [0.1, 0.1], \"start\": {\"at\": [0, 0.5, 0]}}, "
    "{\"particles\": [3, 4], \"size\": [0.1, 0.1], \"start\": {\"at\": "
    "[0, 0.6, 0]}}], \"obstacles\": [{\"shape\": \"plane\"}], \"wind\": {}, "
    "\"camera\": {\"eye\": [0, 1, 2]}}";

bool files_scene(struct scene *scene, drape_world **world)
{
    static const struct overrides as_it_is = {NULL, -1, -1, -1, 0};
    char path[FILES_PATH];
    *world = NULL;
    files_write("scene.json", plain, strlen(plain));
    return scene_load(scene, files_path("scene.json", path)) == APP_OK &&
           scene_create(scene, &as_it_is, world) == APP_OK;
}
