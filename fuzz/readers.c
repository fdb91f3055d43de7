/* SPDX-License-Identifier: Apache-2.0 */
/* Fuzzes the tool's readers of scenes and meshes with any bytes: they refuse
 * the input, or the result is as their headers say. Also holds the table of all
 * targets of readers. */
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "app/base/app.h"
#include "app/read/json.h"
#include "fuzz/files.h"

const struct target fuzz_readers[] = {
    {"scene", fuzz_scene, json_mutate},
    {"ply", fuzz_ply, NULL},
    {"mesh", fuzz_mesh, NULL},
    {"frames", fuzz_frames, NULL},
    {"checkpoint", fuzz_checkpoint, checkpoint_mutate},
    {"csv", fuzz_csv, NULL},
    {"report", fuzz_report, NULL},
    {"report_read", fuzz_look, json_mutate},
    {"pattern", fuzz_pattern, json_mutate},
    {NULL, NULL, NULL}};

enum { PATIENCE = 30, SMALL = 300 };

/* Whether a scene is too large to run here: checks each number under a key that
 * counts things, and the numbers of a list under it. */
static bool too_large(json_t *node, const char *key)
{
    static const char *const keys[] = {"particles", "detail", "count", "folds",
                                       NULL};
    static const double most[] = {33, 32, 4, 1e4};
    const char *name;
    json_t *item;
    size_t k;
    int which = key ? json_choice(keys, key) : -1;
    if (which >= 0 && json_number_value(node) > most[which])
        return true;
    json_object_foreach(node, name, item)
    {
        if (too_large(item, name))
            return true;
    }
    json_array_foreach(node, k, item)
    {
        if (too_large(item, json_is_number(item) ? key : NULL))
            return true;
    }
    return false;
}

static bool fits(const char *path)
{
    json_t *root = json_parse(path);
    bool fits = !root || !too_large(root, NULL);
    json_decref(root);
    return fits;
}

static const char *look_at_settings(const struct scene *scene)
{
    char path[FILES_PATH];
    FILE *out = fopen(files_path("settings.json", path), "wb");
    if (!out)
        return "no file can be made";
    scene_settings(out, scene);
    fclose(out);
    size_t size = 0;
    char *text = files_read("settings.json", &size);
    bool valid = text && strict_json(text, size);
    free(text);
    return valid ? NULL : "settings are not JSON";
}

/* Makes the world of a small scene and takes a step. */
static const char *try_world(struct scene *scene)
{
    static const struct overrides as_it_is = {NULL, -1, -1, -1, 0};
    drape_def *d = &scene->def;
    drape_world *world = NULL;
    d->max_substeps = d->max_substeps < 64 ? d->max_substeps : 64;
    d->max_iterations = d->max_iterations < 100 ? d->max_iterations : 100;
    d->max_rounds = d->max_rounds < 8 ? d->max_rounds : 8;
    d->max_slices = d->max_slices < 4 ? d->max_slices : 4;
    d->threads = 1;
    d->backend = DRAPE_REF;
    d->solver = DRAPE_EXACT;
    scene->memory = scene->memory < 0.05 ? scene->memory : 0.05;
    int status = scene_create(scene, &as_it_is, &world);
    const char *failed = NULL;
    if (status == APP_OK && drape_vertices(world) <= SMALL) {
        drape_step_report r;
        int step = drape_step(world, &r);
        if (step != DRAPE_OK && step != DRAPE_ENOMEM)
            failed = "a step fails";
    } else if (status != APP_OK && status != APP_USAGE &&
               status != APP_FAILED) {
        failed = "an exit code that there is not";
    }
    drape_destroy(world);
    return failed;
}

const char *fuzz_scene(const char *name, const uint8_t *data, size_t size)
{
    static struct scene scene;
    char path[FILES_PATH];
    const char *failed = NULL;
    double begun = (double)clock() / CLOCKS_PER_SEC;
    (void)name;
    files_write("scene.json", data, size);
    if (!fits(files_path("scene.json", path)))
        return NULL;
    int status = scene_load(&scene, path);
    if (status == APP_OK)
        failed = scene.name ? look_at_settings(&scene) : "no name";
    else if (status != APP_USAGE && status != APP_FAILED)
        failed = "an exit code that there is not";
    if (status == APP_OK && !failed)
        failed = try_world(&scene);
    scene_free(&scene);
    if (!failed && (double)clock() / CLOCKS_PER_SEC - begun > PATIENCE)
        failed = "it takes too long";
    return failed;
}

static const char *look_at_mesh(const struct mesh *mesh)
{
    double lo[3], hi[3];
    mesh_box(mesh, lo, hi);
    if (mesh->nt <= 0 || mesh_degenerate(mesh) > mesh->nt)
        return "a mesh of nothing was accepted";
    for (int k = 0; k < 3; k++)
        if (!(hi[k] - lo[k] >= 0 && hi[k] <= 0x1p60 && lo[k] >= -0x1p60))
            return "a number that is not finite was accepted";
    for (int64_t k = 0; k < 3 * mesh->nt; k++)
        if (mesh->tri[k / 3][k % 3] < 0 || mesh->tri[k / 3][k % 3] >= mesh->nv)
            return "an index out of range was accepted";
    return NULL;
}

static const char *try_mesh(const char *name, const uint8_t *data, size_t size)
{
    struct pool pool = {NULL};
    struct mesh mesh;
    struct clip clip = {.name = NULL};
    char path[FILES_PATH];
    files_write(name, data, size);
    int status = mesh_load_clip(&pool, files_path(name, path), &clip, &mesh);
    const char *failed = status == APP_OK ? look_at_mesh(&mesh) : NULL;
    for (int k = 0; status == APP_OK && k < clip.frames && !failed; k++) {
        struct mesh frame = mesh;
        frame.x = clip.x + (size_t)k * (size_t)mesh.nv;
        failed = look_at_mesh(&frame);
    }
    if (status != APP_OK && status != APP_USAGE && status != APP_FAILED)
        failed = "an exit code that there is not";
    pool_free(&pool);
    return failed;
}

const char *fuzz_ply(const char *name, const uint8_t *data, size_t size)
{
    (void)name;
    return try_mesh("in.ply", data, size);
}

/* Fuzzes the mesh readers; the first byte selects the format. */
const char *fuzz_mesh(const char *name, const uint8_t *data, size_t size)
{
    static const char *const files[] = {"in.off", "in.obj", "in.stl", "in.gltf",
                                        "in.glb", "in.dae", "in.fbx"};
    (void)name;
    return size ? try_mesh(files[data[0] % 7], data + 1, size - 1) : NULL;
}

/* The point cache of a mesh of four vertices. */
static const char *fuzz_cache(const uint8_t *data, size_t size)
{
    static const char mesh[] = "OFF\n4 2 0\n0 0 0\n1 0 0\n0 0 1\n1 1 1\n"
                               "3 0 1 2\n3 1 3 2\n";
    static const char scene[] =
        "{\"cloths\": [{\"particles\": [3, 3], \"start\": {\"at\": [0, 9, "
        "0]}}], \"obstacles\": [{\"mesh\": \"cached.off\", \"frames\": "
        "{\"file\": \"in.pc2\", \"between\": \"cubic\"}}]}";
    files_write("cached.off", (const uint8_t *)mesh, strlen(mesh));
    files_write("in.pc2", data, size);
    return fuzz_scene("scene", (const uint8_t *)scene, strlen(scene));
}

/* Fuzzes the frames of an obstacle; the input is cut into frames at lines of
 * dashes, or begins as a point cache does. */
const char *fuzz_frames(const char *name, const uint8_t *data, size_t size)
{
    static const char cut[] = "\n---\n";
    static const char scene[] =
        "{\"cloths\": [{\"particles\": [3, 3], \"start\": {\"at\": [0, 9, "
        "0]}}], \"obstacles\": [{\"frames\": {\"files\": \"wave_%%d.ply\", "
        "\"count\": %d}}]}";
    char text[256], file[16];
    int count = 0;
    (void)name;
    if (size > 4 && memcmp(data, "POIN", 4) == 0)
        return fuzz_cache(data, size);
    for (size_t at = 0; at <= size && count < 3; count++) {
        size_t end = at;
        while (end < size && (size - end < strlen(cut) ||
                              memcmp(data + end, cut, strlen(cut)) != 0))
            end++;
        snprintf(file, sizeof file, "wave_%d.ply", count);
        files_write(file, data + at, end - at);
        at = end + strlen(cut);
    }
    snprintf(text, sizeof text, scene, count);
    return fuzz_scene("scene", (const uint8_t *)text, strlen(text));
}
