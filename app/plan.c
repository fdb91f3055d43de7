/* SPDX-License-Identifier: Apache-2.0 */
/* drape plan: prints which stages of a scene run, why, and their memory. */
#include "app/app.h"
#include "app/scene.h"

#include <stdio.h>
#include <string.h>

enum { ROWS = 128 };

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

int command_plan(int argc, char **argv)
{
    struct overrides overrides = {NULL, -1, -1, -1, 0};
    int positional;
    const struct option_row options[] = {
        {"--backend", OPTION_TEXT, &overrides.backend, 0, 0},
        {"--precision", OPTION_INT, &overrides.precision, 32, 64},
        {"--allow-intersecting", OPTION_FLAG, &overrides.allow_intersecting, 0,
         0},
        {0}};
    int status = options_read(options, argc, argv, &positional);
    if (status != APP_OK)
        return status;
    if (positional != 1)
        return complain(APP_USAGE, "plan: expected one SCENE.json");
    struct scene scene;
    drape_world *world = NULL;
    status = scene_load(&scene, argv[0]);
    if (status == APP_OK)
        status = scene_create(&scene, &overrides, &world);
    if (status == APP_OK)
        print_plan(&scene, world);
    drape_destroy(world);
    scene_free(&scene);
    return status;
}
