/* SPDX-License-Identifier: Apache-2.0 */
/* Writes a mesh in the format that the output's name says: PLY and OBJ by our
 * own writers, without loss; STL, glTF, COLLADA and FBX by assimp (FBX as text:
 * the binary one that assimp 5.2 makes in memory does not read back). */
#include "app/write/export.h"
#include "app/base/app.h"
#include "app/base/file.h"

#include <assimp/cexport.h>
#include <assimp/cimport.h>
#include <assimp/scene.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

/* The endings that can be written, and assimp's name of the format; NULL: it is
 * written without assimp. */
static const struct format {
    const char *ending, *assimp;
} formats[] = {{"ply", NULL},   {"obj", NULL},      {"stl", "stlb"},
               {"glb", "glb2"}, {"dae", "collada"}, {"fbx", "fbxa"}};
enum { FORMATS = sizeof formats / sizeof *formats };

static const struct format *find(const char *path)
{
    const char *dot = strrchr(path, '.');
    if (strcmp(path, "-") == 0)
        return &formats[0];
    for (int k = 0; dot && k < FORMATS; k++)
        if (strcasecmp(dot + 1, formats[k].ending) == 0)
            return &formats[k];
    return NULL;
}

int export_check(const char *path)
{
    if (find(path))
        return APP_OK;
    return complain(APP_USAGE,
                    "%s: cannot be written; expected a name that ends in .ply, "
                    ".obj, .stl, .glb, .dae or .fbx, or - for PLY on standard "
                    "output",
                    path);
}

/* The mesh as assimp holds it, made from a PLY file in memory. NULL: failed. */
static const struct aiScene *give(const struct mesh *mesh)
{
    char *data = NULL;
    size_t size = 0;
    FILE *stream = open_memstream(&data, &size);
    if (!stream)
        return NULL;
    ply_put(stream, mesh, 64);
    const struct aiScene *scene = NULL;
    if (fclose(stream) == 0 && size <= UINT32_MAX)
        scene = aiImportFileFromMemory(data, (unsigned)size, 0, "ply");
    free(data);
    return scene;
}

/* Whether what was written reads back with as many triangles. */
static bool reads_back(const struct aiExportDataBlob *blob, const char *ending,
                       int64_t triangles)
{
    const struct aiScene *scene =
        blob->size <= UINT32_MAX
            ? aiImportFileFromMemory(blob->data, (unsigned)blob->size, 0,
                                     ending)
            : NULL;
    int64_t sum = 0;
    for (unsigned k = 0; scene && k < scene->mNumMeshes; k++)
        sum += scene->mMeshes[k]->mNumFaces;
    aiReleaseImport(scene);
    return sum == triangles;
}

static int put_blob(const struct aiExportDataBlob *blob, const char *directory,
                    const char *name)
{
    struct file file;
    if (!file_open(&file, directory, name))
        return APP_FAILED;
    fwrite(blob->data, blob->size, 1, file.stream);
    return file_close(&file) ? APP_OK : APP_FAILED;
}

/* Writes the scene to memory. FBX has a unit, which its header counts in
 * centimetres: here it is the metre. */
static const struct aiExportDataBlob *write_blob(const struct aiScene *given,
                                                 const char *format)
{
    double metre = 100;
    struct aiString key = {.length = 15, .data = "UnitScaleFactor"};
    struct aiMetadataEntry value = {AI_DOUBLE, &metre};
    struct aiMetadata unit = {1, &key, &value};
    struct aiScene scene = *given;
    scene.mMetaData = &unit;
    return aiExportSceneToBlob(&scene, format, 0);
}

static int save_by_assimp(const char *directory, const char *name,
                          const struct mesh *mesh, const struct format *format)
{
    const struct aiScene *scene = give(mesh);
    const struct aiExportDataBlob *blob =
        scene ? write_blob(scene, format->assimp) : NULL;
    int status = APP_OK;
    if (!blob)
        status = complain(APP_FAILED, "%s: assimp cannot write it: %s", name,
                          aiGetErrorString());
    else if (blob->next || !reads_back(blob, format->ending, mesh->nt))
        status =
            complain(APP_FAILED,
                     "%s: not written, as it would not read back whole", name);
    else
        status = put_blob(blob, directory, name);
    if (blob)
        aiReleaseExportBlob(blob);
    if (scene)
        aiReleaseImport(scene);
    return status;
}

int export_save(const char *path, const struct mesh *mesh)
{
    const struct format *format = find(path);
    char directory[FILE_PATH] = ".";
    const char *slash = strrchr(path, '/'), *name = slash ? slash + 1 : path;
    size_t length = slash ? (size_t)(slash - path) : 0;
    if (strcmp(path, "-") == 0) {
        ply_put(stdout, mesh, 32);
        return APP_OK;
    }
    if (length >= sizeof directory)
        return complain(APP_USAGE, "the path of the output is too long");
    if (slash) {
        memcpy(directory, length ? path : "/", length ? length : 1);
        directory[length ? length : 1] = 0;
    }
    if (format->assimp)
        return save_by_assimp(directory, name, mesh, format);
    bool saved = strcmp(format->ending, "ply") == 0
                     ? ply_save(directory, name, mesh, 32)
                     : obj_save(directory, name, mesh, 32);
    return saved ? APP_OK : APP_FAILED;
}
