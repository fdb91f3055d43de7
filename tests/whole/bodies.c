/* SPDX-License-Identifier: Apache-2.0 */
/* Cloths, obstacles, motions and pins of small scenes. */
#include "tests/whole/whole.h"

#include <math.h>
#include <stdlib.h>

void *show_keep(struct show *s, size_t bytes)
{
    void *p = calloc(1, bytes);
    if (!p || s->n_kept == KEPT) {
        fputs("whole: no memory, or more than KEPT pieces of it\n", stderr);
        exit(2);
    }
    s->kept[s->n_kept++] = p;
    return p;
}

void show_free(struct show *s)
{
    while (s->n_kept > 0)
        free(s->kept[--s->n_kept]);
}

double show_random(uint32_t *state)
{
    *state = *state * 1664525 + 1013904223;
    return (*state >> 8) * 0x1p-23 - 1;
}

drape_cloth *show_cloth(struct show *s, int m, int n, double cell, double y)
{
    drape_cloth *c = &s->cloth[s->def.n_cloths++];
    drape_default_cloth(c);
    c->m = m;
    c->n = n;
    c->width = (m - 1) * cell;
    c->height = (n - 1) * cell;
    c->origin[0] = -0.5 * c->width;
    c->origin[1] = y;
    c->origin[2] = -0.5 * c->height;
    return c;
}

/* A mesh without motion, of so many vertices and triangles. */
static drape_obstacle *mesh(struct show *s, int nv, int nt)
{
    drape_obstacle *o = &s->obstacle[s->def.n_obstacles++];
    drape_default_obstacle(o);
    o->n_vertices = nv;
    o->n_triangles = nt;
    o->x = show_keep(s, (size_t)nv * sizeof *o->x);
    o->tri = show_keep(s, (size_t)nt * sizeof *o->tri);
    return o;
}

/* The arrays of a mesh, to be filled. */
static double (*points(const drape_obstacle *o))[3]
{
    return (double(*)[3])(void *)o->x;
}

static void triangle(const drape_obstacle *o, int k, int a, int b, int c)
{
    int32_t(*tri)[3] = (int32_t(*)[3])(void *)o->tri;
    tri[k][0] = a;
    tri[k][1] = b;
    tri[k][2] = c;
}

drape_obstacle *show_floor(struct show *s, double y, double side)
{
    drape_obstacle *o = mesh(s, 4, 2);
    for (int k = 0; k < 4; k++) {
        points(o)[k][0] = k & 1 ? side : -side;
        points(o)[k][1] = y;
        points(o)[k][2] = k & 2 ? side : -side;
    }
    triangle(o, 0, 0, 2, 1);
    triangle(o, 1, 1, 2, 3);
    return o;
}

drape_obstacle *show_box(struct show *s, double y, double side)
{
    static const int corner[12][3] = {
        {0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
        {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
    drape_obstacle *o = mesh(s, 8, 12);
    for (int k = 0; k < 8; k++) {
        points(o)[k][0] = k & 1 ? 0.5 * side : -0.5 * side;
        points(o)[k][1] = k & 4 ? y + 0.5 * side : y - 0.5 * side;
        points(o)[k][2] = k & 2 ? 0.5 * side : -0.5 * side;
    }
    for (int k = 0; k < 12; k++)
        triangle(o, k, corner[k][0], corner[k][1], corner[k][2]);
    return o;
}

/* Rings of `detail` vertices between two poles. The angles come from a table
 * of dyadic numbers, as cosines differ from one mathematical library to the
 * next. */
drape_obstacle *show_ball(struct show *s, double y, double radius, int detail)
{
    int rings = detail / 2;
    drape_obstacle *o = mesh(s, rings * detail + 2, 2 * rings * detail);
    double(*x)[3] = points(o);
    for (int k = 0; k < rings; k++)
        for (int j = 0; j < detail; j++) {
            double *p = x[k * detail + j], h = 2.0 * (k + 1) / (rings + 1) - 1;
            double t = 4.0 * j / detail, side = floor(t), along = t - side;
            double a = 1 - along, b = along;
            double r = sqrt(1 - h * h) / sqrt(a * a + b * b);
            int quarter = (int)side;
            p[0] = radius * r * (quarter % 2 ? -b : a) * (quarter > 1 ? -1 : 1);
            p[2] = radius * r * (quarter % 2 ? a : b) * (quarter > 1 ? -1 : 1);
            p[1] = y + radius * h;
        }
    int low = rings * detail, high = low + 1, n = 0;
    x[low][1] = y - radius;
    x[high][1] = y + radius;
    for (int j = 0; j < detail; j++) {
        int next = (j + 1) % detail, top = (rings - 1) * detail;
        triangle(o, n++, low, j, next);
        triangle(o, n++, high, top + next, top + j);
        for (int k = 0; k + 1 < rings; k++) {
            int a = k * detail + j, b = k * detail + next;
            triangle(o, n++, a, a + detail, b);
            triangle(o, n++, b, a + detail, b + detail);
        }
    }
    return o;
}

int show_motion(struct show *s, double end, const double way[3], double half)
{
    int k = s->def.n_motions++;
    s->time[k][1] = end;
    for (int i = 0; i < 3; i++)
        s->way[k][1][i] = way[i];
    s->turn[k][0][0] = 1;
    s->turn[k][1][0] = sqrt(1 - half * half);
    s->turn[k][1][2] = half;
    s->motion[k] = (drape_motion){2,
                                  s->time[k],
                                  (const double(*)[3])s->way[k],
                                  (const double(*)[4])s->turn[k],
                                  {0, 0, 0}};
    return k;
}

void show_pin(struct show *s, int i, int j, int motion)
{
    drape_cloth *c = &s->cloth[0];
    s->pin[c->n_pins++] = (drape_pin){i, j, motion};
    c->pins = s->pin;
}
