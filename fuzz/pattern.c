/* SPDX-License-Identifier: Apache-2.0 */
/* Fuzzes sewing patterns: they are refused, or their panels are cut to
 * triangles that are not too small, within one outline each. */
#include <math.h>
#include <stdlib.h>
#include <time.h>

#include "app/base/app.h"
#include "app/read/json.h"
#include "app/write/garment.h"
#include "fuzz/files.h"

/* Seconds, and cells along the largest panel. */
enum { PATIENCE = 20, CELLS = 48 };

static const char *look_at_cells(const struct cut *cut)
{
    int64_t cells = (int64_t)(cut->m - 1) * (cut->n - 1);
    int64_t found = 0;
    for (int64_t c = 0; c < cells; c++) {
        int32_t tri[2][3];
        int count = cut_triangles(cut, c, tri);
        found += count > 0;
        for (int k = 0; k < count; k++) {
            if (!(cut_part(cut, tri[k]) >= 0.999 * CUT_LEAST))
                return "a triangle is too small";
            for (int i = 0; i < 3; i++)
                if (cut->kind[tri[k][i]] == CUT_OUT)
                    return "a cell has a particle that is not there";
        }
    }
    if (found == 0 || found != cut->regular + cut->moved + cut->triangles)
        return "cells are counted wrongly";
    if (!(cut->area > 0) || !isfinite(cut->off) || !isfinite(cut->off_dart))
        return "a measure is no number";
    return NULL;
}

static const char *look_at_panel(const struct garment_panel *panel)
{
    const struct pattern_panel *p = panel->panel;
    int *count = calloc((size_t)p->edges, sizeof *count);
    int64_t sum = 0;
    if (!count)
        return NULL;
    garment_count(panel, count);
    for (int k = 0; k < p->edges; k++)
        sum += count[k];
    free(count);
    if (sum < panel->cut.borders)
        return "a border particle is of no edge";
    return look_at_cells(&panel->cut);
}

/* The largest panel's size; the reader bounds it. */
static double size_of(const struct pattern *pattern)
{
    double size = 0;
    for (int k = 0; k < pattern->panels; k++) {
        const struct pattern_panel *p = &pattern->panel[k];
        for (int e = 1; e < p->edges; e++)
            for (int i = 0; i < 2; i++)
                size =
                    fmax(size, fabs(p->outline[e].a[i] - p->outline[0].a[i]));
    }
    return size;
}

static const char *try_garment(const struct pattern *pattern)
{
    struct garment garment;
    const char *failed = NULL;
    double h = fmax(size_of(pattern) / CELLS, 1e-4);
    int status = garment_cut(&garment, pattern, h);
    if (status != APP_OK && status != APP_USAGE && status != APP_FAILED)
        failed = "an exit code that there is not";
    for (int k = 0; k < pattern->panels && status == APP_OK && !failed; k++)
        failed = look_at_panel(&garment.panel[k]);
    FILE *out = status == APP_OK ? fopen("/dev/null", "wb") : NULL;
    if (out) {
        garment_draw(&garment, out);
        fclose(out);
    }
    garment_free(&garment);
    return failed;
}

const char *fuzz_pattern(const char *name, const uint8_t *data, size_t size)
{
    struct pool pool = {NULL};
    struct pattern pattern;
    char path[FILES_PATH];
    double begun = (double)clock() / CLOCKS_PER_SEC;
    (void)name;
    files_write("pattern.json", data, size);
    int status =
        pattern_load(&pool, files_path("pattern.json", path), &pattern);
    const char *failed = status == APP_OK ? try_garment(&pattern) : NULL;
    if (status != APP_OK && status != APP_USAGE && status != APP_FAILED)
        failed = "an exit code that there is not";
    pool_free(&pool);
    if (!failed && (double)clock() / CLOCKS_PER_SEC - begun > PATIENCE)
        failed = "it takes too long";
    return failed;
}
