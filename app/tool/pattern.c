/* SPDX-License-Identifier: Apache-2.0 */
/* drape pattern: reads a sewing pattern, cuts its panels and tells how near
 * the cells come to what was drawn. */
#include "app/tool/options.h"
#include "app/write/garment.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* m */
static const double least = 1e-4, most = 0.1;

static int read_cell(const char *text, double *h)
{
    char *end;
    *h = strtod(text, &end);
    if (end != text && !*end && *h >= least && *h <= most)
        return APP_OK;
    return complain(APP_USAGE, "--cell %s: expected metres from %g to %g", text,
                    least, most);
}

/* The width of a column of names, at most 40. */
static int width_of(const struct garment *g)
{
    size_t width = strlen("panel");
    for (int k = 0; k < g->pattern->panels; k++) {
        size_t length = strlen(g->pattern->panel[k].name);
        width = length > width ? length : width;
    }
    return width < 40 ? (int)width : 40;
}

static void print_panels(const struct garment *g, int width)
{
    struct cut sum = {0};
    double area = 0, cells = 0;
    printf("%-*s %8s %8s %8s %9s %8s %10s %9s %7s %7s\n", width, "panel",
           "whole", "triangle", "absent", "particles", "border", "area cm²",
           "error", "outline", "darts");
    for (int k = 0; k < g->pattern->panels; k++) {
        const struct garment_panel *p = &g->panel[k];
        const struct cut *c = &p->cut;
        long long whole = c->regular + c->moved;
        printf("%-*.40s %8lld %8lld %8lld %9lld %8lld %9.2f %9.1e %7.2f "
               "%7.2f\n",
               width, p->panel->name, whole, (long long)c->triangles,
               (long long)c->absent, (long long)c->particles,
               (long long)c->borders, 1e4 * p->outline.area,
               garment_area_error(p), c->off, c->off_dart);
        sum.regular += whole;
        sum.triangles += c->triangles;
        sum.absent += c->absent;
        sum.particles += c->particles;
        sum.borders += c->borders;
        sum.off = fmax(sum.off, c->off);
        sum.off_dart = fmax(sum.off_dart, c->off_dart);
        area += p->outline.area;
        cells += c->area;
    }
    printf("%-*s %8lld %8lld %8lld %9lld %8lld %9.2f %9.1e %7.2f %7.2f\n",
           width, "all", (long long)sum.regular, (long long)sum.triangles,
           (long long)sum.absent, (long long)sum.particles,
           (long long)sum.borders, 1e4 * area, cells / area - 1, sum.off,
           sum.off_dart);
}

/* An edge of a panel, as `left_sleeve 3`, padded. */
static void print_side(const struct pattern *pattern,
                       const struct pattern_side *side, int width)
{
    printf(" %-*.40s %2d", width, pattern->panel[side->panel].name, side->edge);
}

/* A stitch is a side of each panel; its points are counted, and its gap is the
 * largest where the pattern places them. */
static int print_seam(const struct garment *g, int k, int width)
{
    const struct pattern_stitch *stitch = &g->pattern->stitch[k];
    struct cut_seam seam;
    double length[2];
    int status = garment_seam(g, stitch, &seam);
    if (status != APP_OK)
        return status;
    garment_lengths(g->pattern, stitch, length);
    printf("%4d", k);
    for (int s = 0; s < 2; s++) {
        print_side(g->pattern, &stitch->side[s], width);
        printf(" %9.2f", 1e3 * length[s]);
    }
    printf(" %6.4f %7d %8.2f%s%s\n", length[0] / length[1], seam.n,
           1e2 * garment_gap(g, stitch, &seam),
           garment_is_dart(g->pattern, stitch) ? " dart" : "",
           stitch->turned ? " right to wrong" : "");
    cut_seam_free(&seam);
    return APP_OK;
}

static int print_seams(const struct garment *g, int width)
{
    const struct pattern *pattern = g->pattern;
    int status = APP_OK;
    if (pattern->stitches)
        printf("\n%4s %-*s %9s %-*s %9s %6s %7s %8s\n", "seam", width + 3,
               "edge", "mm", width + 3, "edge", "mm", "ratio", "points",
               "gap cm");
    for (int k = 0; k < pattern->stitches && status == APP_OK; k++)
        status = print_seam(g, k, width);
    return status;
}

int command_pattern(int argc, char **argv)
{
    const char *cell = NULL, *out = NULL;
    const struct option_row options[] = {
        TEXT_OPTION("--cell", &cell), TEXT_OPTION("--out", &out), {0}};
    int positional;
    double h = 0.005;
    int status = options_read(options, argc, argv, &positional);
    if (status != APP_OK)
        return status;
    if (positional != 1)
        return complain(APP_USAGE, "pattern: expected one FILE");
    if (cell)
        status = read_cell(cell, &h);
    struct pool pool = {0};
    struct pattern pattern;
    struct garment garment = {0};
    if (status == APP_OK)
        status = pattern_load(&pool, argv[0], &pattern);
    if (status == APP_OK)
        status = garment_cut(&garment, &pattern, h);
    if (status == APP_OK && out)
        status = garment_save(&garment, out);
    if (status == APP_OK) {
        int width = width_of(&garment);
        print_panels(&garment, width);
        status = print_seams(&garment, width);
    }
    garment_free(&garment);
    pool_free(&pool);
    return status;
}
