/* SPDX-License-Identifier: Apache-2.0 */
/* A closed outline as a polygon of chords: where it crosses itself, and where
 * it is narrow. */
#include "app/base/outline.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Puts the chords of one edge after those that are there. */
static void put_chords(struct outline *o, int edge, int count)
{
    const struct curve *curve = &o->edge[edge];
    for (int k = 0; k < count; k++, o->n++) {
        curve_point(curve, (double)k / count, o->x[o->n]);
        o->of[o->n] = edge;
    }
}

/* Over how many of the longest chords an outline is moved where an edge is
 * closed up: an edge of length l then changes the area by 2 l chords at most.
 */
enum { PULLED = 4 };

static double cross(const double a[2], const double b[2])
{
    return a[0] * b[1] - a[1] * b[0];
}

/* Moves an end of an edge to a place, and chords near it by less and less, and
 * notes by how much that changes the area. side: 1 at its beginning, -1 at its
 * end, where the polygon has the next edge's beginning. */
static void pull_end(struct outline *o, int edge, int side, const double to[2],
                     double reach)
{
    const struct curve *curve = &o->edge[edge];
    const double *end = side > 0 ? curve->a : curve->b;
    int last = edge + 1 < o->edges ? o->first[edge + 1] : o->n;
    int k = side > 0 ? o->first[edge] : last, left = last - o->first[edge];
    double by[2] = {to[0] - end[0], to[1] - end[1]}, gone = 0;
    double old[2] = {end[0], end[1]}, new[2] = {to[0], to[1]};
    while (left-- > 0 && gone < reach) {
        double *x = o->x[k += side], at[2] = {x[0], x[1]};
        gone += plane_length(at[0] - old[0], at[1] - old[1]);
        double part = left > 0 ? fmax(1 - gone / reach, 0) : 0;
        for (int i = 0; i < 2; i++)
            x[i] += part * by[i];
        o->area += side * (cross(new, x) - cross(old, at)) / 2;
        memcpy(old, at, sizeof old);
        memcpy(new, x, sizeof new);
    }
}

/* Closes the polygon where edges are closed up. */
static void pull_ends(struct outline *o, double reach)
{
    for (int k = 0; k < o->edges; k++) {
        int before = (k + o->edges - 1) % o->edges;
        const double *a = o->edge[before].b, *b = o->edge[k].a;
        double middle[2] = {(a[0] + b[0]) / 2, (a[1] + b[1]) / 2};
        if (a[0] == b[0] && a[1] == b[1])
            continue;
        pull_end(o, before, -1, middle, reach);
        pull_end(o, k, 1, middle, reach);
        memcpy(o->x[o->first[k]], middle, sizeof middle);
    }
}

/* Closes the polygon; lengths and the box. */
static void finish(struct outline *o)
{
    memcpy(o->x[o->n], o->x[0], sizeof o->x[0]);
    o->first[o->edges] = o->n;
    o->s[0] = 0;
    for (int i = 0; i < 2; i++)
        o->lo[i] = o->hi[i] = o->x[0][i];
    for (int k = 0; k < o->n; k++) {
        const double *a = o->x[k], *b = o->x[k + 1];
        o->s[k + 1] = o->s[k] + plane_length(b[0] - a[0], b[1] - a[1]);
        for (int i = 0; i < 2; i++) {
            o->lo[i] = fmin(o->lo[i], a[i]);
            o->hi[i] = fmax(o->hi[i], a[i]);
        }
    }
}

bool outline_make(struct outline *outline, const struct curve *edge, int edges,
                  double error, double longest)
{
    *outline = (struct outline){.edges = edges, .edge = edge};
    struct outline *o = outline;
    o->first = malloc(((size_t)edges + 1) * sizeof *o->first);
    if (!o->first)
        return false;
    int64_t count = 0;
    for (int k = 0; k < edges; k++) {
        o->first[k] = (int32_t)count;
        count += curve_chords(&edge[k], error, longest);
        o->area += curve_area(&edge[k]);
        if (count > INT32_MAX / 4)
            break;
    }
    size_t room = (size_t)count + 1;
    if (count <= INT32_MAX / 4) {
        o->x = malloc(room * sizeof *o->x);
        o->of = malloc(room * sizeof *o->of);
        o->s = malloc(room * sizeof *o->s);
    }
    if (!o->x || !o->of || !o->s) {
        outline_free(o);
        return false;
    }
    o->first[edges] = (int32_t)count;
    for (int k = 0; k < edges; k++)
        put_chords(o, k, o->first[k + 1] - o->first[k]);
    pull_ends(o, PULLED * longest);
    finish(o);
    return true;
}

void outline_free(struct outline *outline)
{
    free(outline->x);
    free(outline->of);
    free(outline->first);
    free(outline->s);
    memset(outline, 0, sizeof *outline);
}

/* Twice the area of a triangle, positive where it is counter-clockwise. */
static double turn_of(const double a[2], const double b[2], const double c[2])
{
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

bool outline_is_right(const struct outline *outline, int32_t chord,
                      const double x[2])
{
    const double *a = outline->x[chord], *b = outline->x[chord + 1];
    double d[2] = {b[0] - a[0], b[1] - a[1]};
    return turn_of(a, b, x) < -1e-9 * (d[0] * d[0] + d[1] * d[1]);
}

/* Whether c, which lies on the line through a and b, is between them. */
static bool is_between(const double a[2], const double b[2], const double c[2])
{
    return fmin(a[0], b[0]) <= c[0] && c[0] <= fmax(a[0], b[0]) &&
           fmin(a[1], b[1]) <= c[1] && c[1] <= fmax(a[1], b[1]);
}

bool segment_meets_ray(const double x[2], const double a[2], const double b[2])
{
    if ((a[1] > x[1]) == (b[1] > x[1]))
        return false;
    double t = (x[1] - a[1]) / (b[1] - a[1]);
    return a[0] + t * (b[0] - a[0]) > x[0];
}

bool segments_meet(const double a[2], const double b[2], const double c[2],
                   const double d[2])
{
    double e = turn_of(a, b, c), f = turn_of(a, b, d);
    double g = turn_of(c, d, a), h = turn_of(c, d, b);
    if (((e > 0 && f < 0) || (e < 0 && f > 0)) &&
        ((g > 0 && h < 0) || (g < 0 && h > 0)))
        return true;
    return (e == 0 && is_between(a, b, c)) || (f == 0 && is_between(a, b, d)) ||
           (g == 0 && is_between(c, d, a)) || (h == 0 && is_between(c, d, b));
}

/* Whether chords j and k meet. Neighbours have an end in common; they meet
 * elsewhere, too, only where the outline turns back on itself. */
static bool chords_meet(const struct outline *o, int j, int k)
{
    const double *a = o->x[j], *b = o->x[j + 1];
    const double *c = o->x[k], *d = o->x[k + 1];
    bool after = (j + 1) % o->n == k, before = (k + 1) % o->n == j;
    if (after && before)
        return true; /* two chords enclose nothing */
    if (!after && !before)
        return segments_meet(a, b, c, d);
    const double *middle = after ? b : a, *one = after ? a : b;
    const double *other = after ? d : c;
    double along = (one[0] - middle[0]) * (other[0] - middle[0]) +
                   (one[1] - middle[1]) * (other[1] - middle[1]);
    return turn_of(one, middle, other) == 0 && along > 0;
}

enum outline_answer outline_crosses(const struct outline *outline,
                                    struct outline_pair *pair)
{
    const struct outline *o = outline;
    struct buckets by;
    enum outline_answer answer = OUTLINE_NO;
    double mean = o->s[o->n] / o->n;
    if (!buckets_make(&by, (const double(*)[2])o->x, NULL, o->n, 2 * mean))
        return OUTLINE_MEMORY;
    for (int q = 0; q < by.m * by.n && answer == OUTLINE_NO; q++)
        for (int64_t f = by.first[q]; f < by.first[q + 1]; f++)
            for (int64_t g = by.first[q]; g < f; g++) {
                int k = by.item[f], j = by.item[g];
                if (answer == OUTLINE_YES || !chords_meet(o, j, k))
                    continue;
                answer = OUTLINE_YES;
                *pair = (struct outline_pair){
                    .edge = {o->of[j < k ? j : k], o->of[j < k ? k : j]},
                    .x = {o->x[j][0], o->x[j][1]}};
            }
    buckets_free(&by);
    return answer;
}

/* The middle of a chord and its direction, of length 1. */
static void middle_of(const struct outline *o, int k, double x[2], double t[2])
{
    const double *a = o->x[k], *b = o->x[k + 1];
    double length = plane_length(b[0] - a[0], b[1] - a[1]);
    for (int i = 0; i < 2; i++) {
        x[i] = (a[i] + b[i]) / 2;
        t[i] = length > 0 ? (b[i] - a[i]) / length : 0;
    }
}

/* What chords j and k are to each other, seen from the middle of j: a strap or
 * a gap that is narrower than the one in `strap` or `gap`. */
static void look(const struct outline *o, int j, int k,
                 struct outline_pair *strap, struct outline_pair *gap)
{
    static const double facing = -0.99; /* cosine of 172 degrees */
    int e = o->of[j], f = o->of[k];
    double x[2], t[2], y[2], u[2], near[2];
    if (e == f ? abs(j - k) < 3
               : (e + 1) % o->edges == f || (f + 1) % o->edges == e)
        return;
    middle_of(o, j, x, t);
    middle_of(o, k, y, u);
    double width = segment_distance(x, o->x[k], o->x[k + 1], near);
    double inward = (near[1] - x[1]) * t[0] - (near[0] - x[0]) * t[1];
    struct outline_pair *of = inward > 0 ? strap : gap;
    if (!(t[0] * u[0] + t[1] * u[1] < facing) ||
        !(fabs(inward) > 0.9 * width) || !(width < of->width))
        return;
    /* the end of a strap is as near to its sides */
    double along = fabs(o->s[j] - o->s[k]);
    if (fmin(along, o->s[o->n] - along) > 4 * width)
        *of = (struct outline_pair){{e, f}, {x[0], x[1]}, width};
}

enum outline_answer outline_narrow(const struct outline *outline, double width,
                                   struct outline_pair *strap,
                                   struct outline_pair *gap)
{
    const struct outline *o = outline;
    struct buckets by;
    strap->width = gap->width = INFINITY;
    if (!buckets_make(&by, (const double(*)[2])o->x, NULL, o->n, width))
        return OUTLINE_MEMORY;
    for (int k = 0; k < o->n; k++) {
        double x[2], t[2];
        middle_of(o, k, x, t);
        int lo[2], hi[2];
        for (int i = 0; i < 2; i++) {
            lo[i] = bucket_of(&by, i, x[i] - width);
            hi[i] = bucket_of(&by, i, x[i] + width);
        }
        for (int j = lo[1]; j <= hi[1]; j++) {
            int64_t a = by.first[lo[0] + by.m * j];
            int64_t b = by.first[hi[0] + by.m * j + 1];
            for (; a < b; a++)
                look(o, k, by.item[a], strap, gap);
        }
    }
    buckets_free(&by);
    strap->width = strap->width < width ? strap->width : INFINITY;
    gap->width = gap->width < width ? gap->width : INFINITY;
    return isfinite(strap->width) || isfinite(gap->width) ? OUTLINE_YES
                                                          : OUTLINE_NO;
}
