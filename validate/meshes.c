/* SPDX-License-Identifier: Apache-2.0 */
/* The meshes that sheets slide down. spec/validation.md §9 */
#include "validate/ground.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

void ground_near(const struct ground *g, const double at[3], double reach,
                 drape_obstacle *obstacle)
{
    int32_t(*tri)[3] = take((size_t)g->nt, sizeof *tri);
    int32_t *number = take((size_t)g->nv, sizeof *number);
    double(*x)[3] = take((size_t)g->nv, sizeof *x);
    int32_t nt = 0, nv = 0;
    for (int64_t t = 0; t < g->nt; t++) {
        if (!(apart3(g->x[g->tri[t][0]], at) < reach))
            continue;
        for (int k = 0; k < 3; k++) {
            int32_t v = g->tri[t][k];
            if (!number[v]) {
                memcpy(x[nv], g->x[v], sizeof *x);
                number[v] = ++nv; /* 0: not among them */
            }
            tri[nt][k] = number[v] - 1;
        }
        nt++;
    }
    free(number);
    drape_default_obstacle(obstacle);
    obstacle->n_vertices = nv;
    obstacle->n_triangles = nt;
    obstacle->x = (const double(*)[3])x;
    obstacle->tri = (const int32_t(*)[3])tri;
}

/* How far x is to be moved along n to be `gap` above the plane of triangle t;
 * NAN where the line does not come out of the triangle. */
static double lift_of(const drape_obstacle *obstacle, int64_t t,
                      const double x[3], const double n[3], double gap)
{
    double to[3][3], side[3], area[3] = {0}, inside = INFINITY;
    for (int k = 0; k < 3; k++)
        for (int c = 0; c < 3; c++)
            to[k][c] = obstacle->x[obstacle->tri[t][k]][c] - x[c];
    for (int k = 0; k < 3; k++) {
        cross3(to[k], to[(k + 1) % 3], side);
        inside = fmin(inside, dot3(side, n));
        for (int c = 0; c < 3; c++)
            area[c] += side[c];
    }
    double facing = dot3(area, n);
    if (!(inside >= 0 && facing > 0))
        return NAN;
    return (dot3(area, to[0]) + gap * sqrt(dot3(area, area))) / facing;
}

double ground_lift(const drape_obstacle *obstacle, const double x[3],
                   const double n[3], double gap)
{
    double most = NAN;
    for (int64_t t = 0; t < obstacle->n_triangles; t++) {
        double lift = lift_of(obstacle, t, x, n, gap);
        /* What is farther is another part of the statue. */
        if (fabs(lift) < 0.02 && !(lift <= most))
            most = lift;
    }
    return most;
}

/* A number in 0 … 1 that looks random: Thomas Wang's hash of 32 bits. */
static double noise(uint32_t k)
{
    k = (k ^ 61) ^ (k >> 16);
    k *= 9;
    k ^= k >> 4;
    k *= 0x27d4eb2dU;
    return (double)(k ^ (k >> 15)) / 4294967296.0;
}

/* The boulder's radius in a direction: 1 m and 12 waves, each with a length of
 * 0.35 to 0.7 m and a curvature of 0.7/m at most. */
static double radius_of(const double direction[3])
{
    const double turn = 2 * acos(-1);
    double radius = 1;
    for (uint32_t k = 0; k < 12; k++) {
        double up = 2 * noise(4 * k) - 1, round = turn * noise(4 * k + 1);
        double flat = sqrt(1 - up * up);
        double wave[3] = {flat * cos(round), up, flat * sin(round)};
        double rate = turn / (0.35 * (1 + noise(4 * k + 2)));
        radius += 0.7 / (rate * rate) *
                  sin(rate * dot3(wave, direction) + 10 * noise(4 * k + 3));
    }
    return radius;
}

/* A vertex of the boulder: row i, down from its top, and j, about its axis. */
static void place(double i, double j, double off, double x[3])
{
    const double direction[3] = {sin(i) * cos(j), cos(i), sin(i) * sin(j)};
    double radius = radius_of(direction) + off;
    for (int c = 0; c < 3; c++)
        x[c] = radius * direction[c];
}

void ground_boulder(struct ground *g, double facet, double rough)
{
    int rows = (int)(1.5 / facet), m = (int)(2.4 / facet);
    memset(g, 0, sizeof *g);
    g->nv = (int64_t)m * rows;
    g->x = take((size_t)g->nv, sizeof *g->x);
    g->tri = take((size_t)(2 * g->nv), sizeof *g->tri);
    for (int k = 0; k < m * rows; k++) {
        uint32_t seed = 100 + 3 * (uint32_t)k;
        place(facet * (k / m + 0.6 * noise(seed)),
              facet * (k % m + 0.6 * noise(seed + 1)),
              rough * (2 * noise(seed + 2) - 1), g->x[k]);
    }
    for (int k = 0; k < m * (rows - 1); k++) {
        if (k % m + 1 == m)
            continue;
        int32_t p = k, q = k + m;
        bool turned = noise(7 + 3 * (uint32_t)k) < 0.5;
        const int32_t two[2][3] = {{p, turned ? q + 1 : p + 1, q},
                                   {p + 1, q + 1, turned ? p : q}};
        memcpy(g->tri + g->nt, two, sizeof two);
        g->nt += 2;
    }
}

/* The header of a mesh as `drape convert` writes it: vertices of three floats,
 * faces of three indices. */
static bool read_header(FILE *f, struct ground *g)
{
    char line[256];
    long n;
    int numbers = 0;
    while (fgets(line, sizeof line, f) &&
           strncmp(line, "end_header", 10) != 0) {
        if (sscanf(line, "element vertex %ld", &n) == 1)
            g->nv = n;
        if (sscanf(line, "element face %ld", &n) == 1)
            g->nt = n;
        numbers += !strncmp(line, "property float", 14);
        if (!strncmp(line, "format", 6) && !strstr(line, "little_endian"))
            return false;
    }
    return numbers == 3 && g->nv > 0 && g->nt > 0;
}

static bool read_body(FILE *f, struct ground *g)
{
    float x[3];
    uint8_t corners;
    for (int64_t k = 0; k < g->nv; k++) {
        if (fread(x, sizeof x, 1, f) != 1)
            return false;
        for (int c = 0; c < 3; c++)
            g->x[k][c] = x[c];
    }
    for (int64_t k = 0; k < g->nt; k++)
        if (fread(&corners, 1, 1, f) != 1 || corners != 3 ||
            fread(g->tri[k], sizeof *g->tri, 1, f) != 1)
            return false;
    for (int64_t k = 0; k < 3 * g->nt; k++)
        if (g->tri[k / 3][k % 3] < 0 || g->tri[k / 3][k % 3] >= g->nv)
            return false;
    return true;
}

static bool read_ply(FILE *f, struct ground *g)
{
    memset(g, 0, sizeof *g);
    if (!read_header(f, g))
        return false;
    g->x = take((size_t)g->nv, sizeof *g->x);
    g->tri = take((size_t)g->nt, sizeof *g->tri);
    if (read_body(f, g))
        return true;
    ground_free(g);
    return false;
}

/* Opens NAME.ply where the tool looks for meshes: in the folders of
 * $DRAPE_MODELS, of which an empty name is the current folder, in models/ of
 * $DRAPE_DATA, or of build/data, and in build/models. */
static FILE *open_statue(const char *name)
{
    const char *own = getenv("DRAPE_MODELS"), *data = getenv("DRAPE_DATA");
    char list[4096], path[4096];
    FILE *f = NULL;
    snprintf(list, sizeof list, "%s:%s/models:build/models", own ? own : "",
             data && *data ? data : "build/data");
    for (const char *at = list; at && !f;) {
        int length = (int)strcspn(at, ":");
        snprintf(path, sizeof path, "%.*s/%s.ply", length ? length : 1,
                 length ? at : ".", name);
        f = fopen(path, "rb");
        at = at[length] ? at + length + 1 : NULL;
    }
    return f;
}

bool ground_statue(struct ground *g, const char *name, double size)
{
    FILE *f = open_statue(name);
    bool good = f && read_ply(f, g);
    double extent = 0;
    if (f)
        fclose(f);
    for (int c = 0; c < 3 && good; c++) {
        double lo = INFINITY, hi = -INFINITY;
        for (int64_t k = 0; k < g->nv; k++) {
            lo = fmin(lo, g->x[k][c]);
            hi = fmax(hi, g->x[k][c]);
        }
        extent = fmax(extent, hi - lo);
    }
    for (int64_t k = 0; good && k < g->nv; k++)
        for (int c = 0; c < 3; c++)
            g->x[k][c] *= size / extent;
    return good;
}
