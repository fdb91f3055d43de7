/* SPDX-License-Identifier: Apache-2.0 */
/* Fuzzes the checkpoint of a run with any bytes: it is refused, or the run goes
 * on from it and its report is valid JSON. */
#include "app/write/checkpoint.h"

#include <stdlib.h>
#include <string.h>

#include "app/base/app.h"
#include "fuzz/files.h"

static const char *folder_of(char folder[FILES_PATH])
{
    files_path("checkpoint.drape", folder);
    *strrchr(folder, '/') = 0;
    return folder;
}

/* Loads the checkpoint file as `drape run` does. The scene keeps its own
 * settings, because its world already exists. */
static int load(struct report *report, const struct scene *scene,
                drape_world *world)
{
    char path[FILES_PATH];
    struct checkpoint checkpoint;
    struct scene settings = *scene;
    int status =
        checkpoint_open(&checkpoint, files_path("checkpoint.drape", path));
    if (status == APP_OK)
        status = checkpoint_settings(&checkpoint, &settings);
    if (status == APP_OK)
        status = checkpoint_load(&checkpoint, report, world);
    checkpoint_close(&checkpoint);
    return status;
}

/* The output of a loaded run is valid JSON and a checkpoint that loads. */
static const char *go_on(struct report *report, const struct scene *scene,
                         drape_world *world)
{
    char folder[FILES_PATH];
    struct report again = {.start = report->start};
    size_t size = 0, more = 0;
    if (!report_write(report, scene, world, folder_of(folder), "complete"))
        return "the report cannot be written";
    char *text = files_read("report.json", &size);
    bool valid = text && strict_json(text, size);
    free(text);
    if (!valid)
        return "the report of what was loaded is not JSON";
    if (checkpoint_save(folder, report, scene, world) != APP_OK)
        return "what was loaded cannot be saved";
    char *first = files_read("checkpoint.drape", &size);
    int status = load(&again, scene, world);
    if (status == APP_OK)
        status = checkpoint_save(folder, &again, scene, world);
    char *second = files_read("checkpoint.drape", &more);
    bool same = first && second && size == more && !memcmp(first, second, size);
    report_free(&again);
    free(first);
    free(second);
    return status == APP_OK && same ? NULL : "what was saved loads otherwise";
}

static const char *try_load(struct scene *scene, drape_world *world, bool own)
{
    struct report report = {0};
    const char *failed = NULL;
    bool good = checkpoint_start(world, &report.start) == DRAPE_OK;
    int status = load(&report, scene, world);
    if (!good || (status != APP_OK && status != APP_USAGE))
        failed = "an exit code that there is not";
    else if (status == APP_OK)
        failed = go_on(&report, scene, world);
    else if (own)
        failed = "a run's own checkpoint is refused";
    if (!failed && drape_step(world, NULL) != DRAPE_OK)
        failed = "a step fails";
    report_free(&report);
    return failed;
}

size_t checkpoint_begin(uint8_t *data, size_t size, size_t most)
{
    static struct scene scene;
    char folder[FILES_PATH];
    drape_world *world;
    drape_step_report step;
    struct report report = {0};
    size_t bytes = 0;
    memset(&step, 0, sizeof step);
    bool made = files_scene(&scene, &world) &&
                checkpoint_start(world, &report.start) == DRAPE_OK;
    for (int k = 0; made && k < 2; k++)
        made =
            drape_step(world, &step) == DRAPE_OK && report_add(&report, &step);
    made = made &&
           checkpoint_save(folder_of(folder), &report, &scene, world) == APP_OK;
    char *text = made ? files_read("checkpoint.drape", &bytes) : NULL;
    if (text && bytes <= most) {
        memcpy(data, text, bytes);
        size = bytes;
    }
    free(text);
    report_free(&report);
    drape_destroy(world);
    scene_free(&scene);
    return size;
}

/* Whether the bytes, as far as they go, name the same formats and the same
 * start as the run's own checkpoint. The start is a digest of the library's own
 * checkpoint, with its format. Bytes that do not begin as a checkpoint pass. */
static bool matches(const uint8_t *data, size_t size)
{
    static uint8_t sound[1 << 14];
    const size_t family = strlen("drape run ");
    const size_t head = offsetof(struct checkpoint_header, steps);
    if (checkpoint_begin(sound, 0, sizeof sound) < head)
        return false;
    return size < family || memcmp(data, sound, family) != 0 ||
           !memcmp(data, sound, size < head ? size : head);
}

/* An input of one byte or less stands for an undamaged checkpoint of the
 * run. */
const char *fuzz_checkpoint(const char *name, const uint8_t *data, size_t size)
{
    static struct scene scene;
    static uint8_t sound[1 << 14];
    drape_world *world;
    bool own = size < 2;
    (void)name;
    if (own) {
        size = checkpoint_begin(sound, 0, sizeof sound);
        data = sound;
    }
    const char *failed = "a plain scene is refused";
    if (files_scene(&scene, &world)) {
        files_write("checkpoint.drape", data, size);
        failed = try_load(&scene, world, own);
        if (!failed && fuzz_kept && !matches(data, size))
            failed = "the checkpoint is of another format or run";
    }
    drape_destroy(world);
    scene_free(&scene);
    return failed;
}
