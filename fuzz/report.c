/* SPDX-License-Identifier: Apache-2.0 */
/* Fuzzes reports: whatever the scene's name and the steps' numbers, the output
 * is valid JSON that `render` reads; and `render` accepts any file as input
 * without failing otherwise than by an error. */
#include <stdlib.h>
#include <string.h>

#include "app/base/app.h"
#include "app/render/model.h"
#include "app/write/report.h"
#include "fuzz/draw.h"
#include "fuzz/files.h"

/* Draws a name of any bytes. */
static void draw_name(struct bytes *b, char name[64])
{
    uint32_t n = pick(b, 63);
    for (uint32_t k = 0; k < n; k++)
        name[k] = (char)(1 + pick(b, 255));
    name[n] = 0;
}

/* Draws a step's report of any numbers; counts stay within their possible
 * range. */
static void draw_step(struct bytes *b, drape_step_report *s)
{
    int *few[] = {&s->slices,     &s->substeps,    &s->iterations, &s->rounds,
                  &s->work.tries, &s->work.solves, &s->work.narrow};
    int64_t *many[] = {&s->contacts,      &s->impacts,      &s->candidates,
                       &s->zone_vertices, &s->rolled_back,  &s->work.boxes,
                       &s->work.walked,   &s->work.cleared, &s->work.later};
    double *real[] = {&s->time,
                      &s->residual,
                      &s->kinetic,
                      &s->elastic,
                      &s->potential,
                      &s->seconds[0],
                      &s->seconds[DRAPE_PART_COUNT - 1]};
    memset(s, 0, sizeof *s);
    s->outcome = (int)pick(b, 64);
    for (size_t k = 0; k < sizeof few / sizeof *few; k++)
        *few[k] = (int)pick(b, 1 << 20);
    for (size_t k = 0; k < sizeof many / sizeof *many; k++)
        *many[k] = choose(b);
    for (size_t k = 0; k < sizeof real / sizeof *real; k++)
        *real[k] = draw_any(b);
}

static const char *look_at_report(void)
{
    char folder[FILES_PATH], path[FILES_PATH];
    struct pool pool = {NULL};
    struct run_look look;
    size_t size = 0;
    char *text = files_read("report.json", &size);
    bool valid = text && strict_json(text, size);
    free(text);
    if (!valid)
        return "the report is not JSON";
    files_path("report.json", path);
    strcpy(folder, path);
    *strrchr(folder, '/') = 0;
    int status = look_load(&pool, folder, &look);
    bool same = look.count == 2 && look.cloths[1].first == 16;
    pool_free(&pool);
    return status == APP_OK && same ? NULL : "render does not read the report";
}

static const char *write_report(struct bytes *b, struct scene *scene,
                                const drape_world *world)
{
    char name[5][64], folder[FILES_PATH];
    struct report report = {0};
    for (int k = 0; k < 5; k++)
        draw_name(b, name[k]);
    scene->name = name[0];
    strcpy(scene->file, name[1]);
    scene->cloth_name[0] = name[2];
    scene->cloth_name[1] = name[3];
    scene->obstacle_name[0] = name[4];
    for (uint32_t k = pick(b, 3); k; k--) {
        drape_step_report step;
        draw_step(b, &step);
        if (!report_add(&report, &step))
            abort();
    }
    report.seconds = draw_any(b);
    if (pick(b, 4) == 3)
        report.estimate = (struct estimate){
            .asked = draw_any(b), .error = draw_any(b), .horizon = draw_any(b)};
    files_path("report.json", folder);
    *strrchr(folder, '/') = 0;
    bool written = report_write(&report, scene, world, folder, "complete");
    report_free(&report);
    return written ? look_at_report() : "the report cannot be written";
}

const char *fuzz_report(const char *name, const uint8_t *data, size_t size)
{
    static uint32_t words[DRAW_WORDS];
    static struct scene scene;
    drape_world *world;
    struct bytes b = draw_open(data, size, words);
    (void)name;
    const char *failed = files_scene(&scene, &world)
                             ? write_report(&b, &scene, world)
                             : "a plain scene is refused";
    drape_destroy(world);
    scene_free(&scene);
    choices_free(&b);
    return failed;
}

const char *fuzz_look(const char *name, const uint8_t *data, size_t size)
{
    char folder[FILES_PATH];
    struct pool pool = {NULL};
    struct run_look look;
    struct model model;
    (void)name;
    files_write("report.json", data, size);
    files_path("report.json", folder);
    *strrchr(folder, '/') = 0;
    int status = look_load(&pool, folder, &look);
    if (status == APP_OK)
        status = model_load(&pool, folder, 0, &look, &model);
    pool_free(&pool);
    return status == APP_OK || status == APP_USAGE
               ? NULL
               : "an exit code that there is not";
}
