/* SPDX-License-Identifier: Apache-2.0 */
/* drape convert: places a mesh (rotates, scales, levels) and writes it in
 * the format of its name.
 */
#include "app/tool/options.h"
#include "app/write/export.h"

#include <stdio.h>
#include <string.h>

static int read_direction(const char *text, double d[3])
{
    char end;
    if (sscanf(text, "%lf,%lf,%lf%c", &d[0], &d[1], &d[2], &end) == 3 &&
        d[0] * d[0] + d[1] * d[1] + d[2] * d[2] > 0)
        return APP_OK;
    return complain(APP_USAGE, "--up %s: expected X,Y,Z, not zero", text);
}

static int read_size(const char *text, double *size)
{
    char end;
    if (sscanf(text, "%lf%c", size, &end) == 1 && *size > 0 && *size < 1e6)
        return APP_OK;
    return complain(APP_USAGE, "--size %s: expected metres above 0", text);
}

int command_convert(int argc, char **argv)
{
    const char *up = NULL, *size = NULL;
    const struct option_row options[] = {
        TEXT_OPTION("--up", &up), TEXT_OPTION("--size", &size), {0}};
    int positional;
    int status = options_read(options, argc, argv, &positional);
    if (status != APP_OK)
        return status;
    if (positional != 2)
        return complain(APP_USAGE, "convert: expected IN and OUT");
    struct placement placement = {.scale = 1, .stand = 1};
    status = export_check(argv[1]);
    if (status == APP_OK && up)
        status = read_direction(up, placement.up);
    if (status == APP_OK && size)
        status = read_size(size, &placement.size);
    struct pool pool = {0};
    struct mesh mesh;
    if (status == APP_OK)
        status = mesh_load(&pool, argv[0], &mesh);
    if (status == APP_OK) {
        mesh_place(&mesh, &placement);
        status = export_save(argv[1], &mesh);
    }
    if (status == APP_OK && strcmp(argv[1], "-") != 0)
        say("%s: %lld vertices, %lld triangles\n", argv[1], (long long)mesh.nv,
            (long long)mesh.nt);
    pool_free(&pool);
    return status;
}
