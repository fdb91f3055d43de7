/* SPDX-License-Identifier: Apache-2.0 */
/* drape plan: prints which stages of a scene run, why, their memory, and what a
 * step will take. */
#include "app/scene/scene.h"
#include "app/tool/options.h"
#include "app/tool/speed.h"

#include <stdio.h>
#include <string.h>

enum { ROWS = 128, MACHINES = 32 };

static void print_plan(const struct scene *scene, const drape_world *world)
{
    drape_plan_row row[ROWS];
    int rows = drape_plan(world, row, ROWS);
    rows = rows < ROWS ? rows : ROWS;
    size_t sum = 0;
    int width = 5;
    for (int k = 0; k < rows; k++) {
        int length = (int)strlen(row[k].stage);
        width = length > width ? length : width;
        sum += row[k].bytes;
    }
    printf("%s: %lld vertices, %lld triangles\n\n", scene->name,
           (long long)drape_vertices(world), (long long)drape_triangles(world));
    printf("%-*s      %12s  why\n", width, "stage", "bytes");
    for (int k = 0; k < rows; k++)
        printf("%-*s  %-3s %12zu  %s\n", width, row[k].stage,
               row[k].on ? "on" : "off", row[k].bytes, row[k].why);
    printf("%-*s      %12zu\n", width, "sum", sum);
    printf("%-*s      %12zu\n", width, "held", scene->budget.held);
}

/* Contacts a particle: a sheet on a statue has 0.02 to 0.2, stacks 0.6 to 1.1.
 */
static const double TOUCHING[] = {0, 0.1, 1};

static void print_machine(const struct speed *s, double particles)
{
    printf("%-26s", s->machine);
    for (size_t k = 0; k < sizeof TOUCHING / sizeof *TOUCHING; k++) {
        double ms = speed_step(s, particles, TOUCHING[k] * particles);
        printf(ms < 100 ? " %8.3g" : " %8.0f", ms);
    }
    printf("  %.2g to %.2g   %s, binary%d", s->low, s->high, s->backend,
           s->bits);
    if (s->threads > 0)
        printf(", %d thread%s", s->threads, s->threads > 1 ? "s" : "");
    printf(", %s\n", s->date);
}

/* Prints what a step takes on each machine that was measured. */
static void print_estimate(const struct scene *scene, const struct speed *rows,
                           int n)
{
    if (scene->def.integrator < DRAPE_BW) {
        printf("\nms a step: not estimated for an explicit integrator\n");
        return;
    }
    printf("\n%-26s ms a step, by contacts a particle\n", "estimate");
    printf("%-26s %8s %8s %8s  eight steps of ten take, times that\n",
           "machine", "none", "0.1", "1");
    for (int k = 0; k < n; k++)
        print_machine(&rows[k], scene->particles);
}

int command_plan(int argc, char **argv)
{
    struct overrides overrides = {NULL, -1, -1, -1, 0};
    int positional;
    const char *measured = NULL;
    const struct option_row options[] = {
        TEXT_OPTION("--backend", &overrides.backend),
        BITS_OPTION("--precision", &overrides.precision),
        FLAG_OPTION("--allow-intersecting", &overrides.allow_intersecting),
        TEXT_OPTION("--speed", &measured),
        {0}};
    int status = options_read(options, argc, argv, &positional);
    if (status != APP_OK)
        return status;
    if (positional != 1)
        return complain(APP_USAGE, "plan: expected one SCENE.json");
    struct speed speeds[MACHINES];
    int machines = speed_read(measured, speeds, MACHINES);
    if (machines < 0)
        return APP_USAGE;
    struct scene scene;
    drape_world *world = NULL;
    status = scene_load(&scene, argv[0]);
    if (status == APP_OK)
        status = scene_create(&scene, &overrides, &world);
    if (status == APP_OK) {
        scene_idle(&scene, &overrides);
        print_plan(&scene, world);
        print_estimate(&scene, speeds, machines);
    }
    drape_destroy(world);
    scene_free(&scene);
    return status;
}
