/* SPDX-License-Identifier: Apache-2.0 */
/* Makes sheets and obstacles for scenes with contact. */
#include "bench/accuracy.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

void cloth_flat(drape_cloth *c, int side, double size, double height)
{
    drape_default_cloth(c);
    c->m = c->n = side;
    c->width = c->height = size;
    c->origin[0] = c->origin[2] = -size / 2;
    c->origin[1] = height;
}

static void make(struct solid *s, int64_t vertices, int64_t triangles)
{
    drape_default_obstacle(&s->body);
    s->x = bench_take((size_t)vertices, sizeof *s->x);
    s->tri = bench_take((size_t)triangles, sizeof *s->tri);
    s->body.n_vertices = vertices;
    s->body.n_triangles = triangles;
    s->body.x = (const double(*)[3])s->x;
    s->body.tri = (const int32_t(*)[3])s->tri;
}

/* Makes a sphere of rings of `detail` vertices; the two poles are the last
 * vertices. */
void solid_ball(struct solid *s, double radius, const double at[3], int detail)
{
    const double pi = 3.14159265358979323846;
    int rings = detail / 2 - 1, n = rings * detail, t = 0;
    make(s, n + 2, 2 * (int64_t)n);
    for (int p = 0; p < n + 2; p++) {
        double a = pi * (p / detail + 1) / (rings + 1);
        double b = 2 * pi * (p % detail) / detail;
        double x[3] = {sin(a) * cos(b), cos(a), sin(a) * sin(b)};
        if (p >= n) {
            x[0] = x[2] = 0;
            x[1] = p == n ? 1 : -1;
        }
        for (int k = 0; k < 3; k++)
            s->x[p][k] = at[k] + radius * x[k];
    }
    for (int p = 0; p < n; p++) {
        int right = p / detail * detail + (p + 1) % detail;
        bool first = p < detail, last = p + detail >= n;
        int32_t up[3] = {p, right, first ? n : right - detail};
        int32_t down[3] = {p, last ? n + 1 : p + detail, right};
        memcpy(s->tri[t++], up, sizeof up);
        memcpy(s->tri[t++], down, sizeof down);
    }
}

void solid_plane(struct solid *s, double size, double slope)
{
    static const int32_t two[2][3] = {{0, 2, 1}, {1, 2, 3}};
    make(s, 4, 2);
    memcpy(s->tri, two, sizeof two);
    for (int k = 0; k < 4; k++) {
        double a = k & 1 ? size / 2 : -size / 2;
        s->x[k][0] = a * cos(slope);
        s->x[k][1] = -a * sin(slope);
        s->x[k][2] = k & 2 ? size / 2 : -size / 2;
    }
}

void solid_free(struct solid *s)
{
    free(s->x);
    free(s->tri);
}
