/* SPDX-License-Identifier: Apache-2.0 */
/* Cuts a panel: how far the cells are from what was to be cut.
 * app/patterns/README.md §7. */
#include "app/base/cut.h"

#include <math.h>
#include <stdlib.h>

/* The tip of a dart: beside it the outline may be off. */
struct tip {
    double x[2], radius;
};

struct measure {
    const struct cut *cut;
    const struct border *border;
    int tips, ends;
    struct tip *tip;      /* [tips] */
    int32_t (*end)[2];    /* [ends] edges of cells, particles */
    struct buckets cells; /* the edges */
};

/* A dart narrows to its tip. Within a cell's width it cannot be cut. */
static void find_tips(struct measure *b)
{
    static const double dart = 1; /* rad, the widest one */
    const struct outline *o = b->border->outline;
    for (int k = 0; k < o->edges; k++) {
        int c = o->first[k];
        const double *x = o->x[c], *y = o->x[c + 1];
        const double *w = o->x[c ? c - 1 : o->n - 1];
        double in[2] = {x[0] - w[0], x[1] - w[1]};
        double out[2] = {y[0] - x[0], y[1] - x[1]};
        double sine = in[0] * out[1] - in[1] * out[0];
        double cosine = in[0] * out[0] + in[1] * out[1];
        double open = acos(-1) + atan2(sine, cosine); /* outside the panel */
        if (open < dart)
            b->tip[b->tips++] = (struct tip){
                .x = {x[0], x[1]},
                .radius = b->cut->h * (1 + 0.6 / sin(fmax(open / 2, 0.01)))};
    }
}

static void find_border(struct measure *b)
{
    int64_t cells = (int64_t)(b->cut->m - 1) * (b->cut->n - 1);
    for (int64_t c = 0; c < cells; c++) {
        int32_t p[4];
        int count = cut_corners(b->cut, c, p);
        for (int k = 0; k < count; k++) {
            if (!cut_is_border(b->cut, c, k, count))
                continue;
            if (b->end) {
                b->end[b->ends][0] = p[k];
                b->end[b->ends][1] = p[(k + 1) % count];
            }
            b->ends++;
        }
    }
}

/* Distance of a point to the nearest segment x[end[2k]], x[end[2k + 1]]. */
static double nearest(const struct buckets *by, const double (*x)[2],
                      const int32_t (*end)[2], const double p[2])
{
    double best = INFINITY, near[2];
    int i = bucket_of(by, 0, p[0]), j = bucket_of(by, 1, p[1]);
    for (int r = 0; r < by->m + by->n && best > (r - 1) * by->size; r++)
        for (int v = j - r; v <= j + r; v++) {
            /* the ring's upper and lower row whole, of others the two ends */
            int step = v == j - r || v == j + r || r == 0 ? 1 : 2 * r;
            for (int u = i - r; u <= i + r && v >= 0 && v < by->n; u += step) {
                if (u < 0 || u >= by->m)
                    continue;
                int64_t q = u + (int64_t)by->m * v;
                for (int64_t f = by->first[q]; f < by->first[q + 1]; f++) {
                    int k = by->item[f];
                    double d =
                        segment_distance(p, x[end ? end[k][0] : k],
                                         x[end ? end[k][1] : k + 1], near);
                    best = fmin(best, d);
                }
            }
        }
    return best;
}

/* Counts the distance of a point of the outline or of the border. */
static void count(struct cut *cut, const struct measure *b, const double x[2],
                  double distance)
{
    double *off = &cut->off;
    for (int k = 0; k < b->tips; k++) {
        const struct tip *tip = &b->tip[k];
        if (plane_length(x[0] - tip->x[0], x[1] - tip->x[1]) < tip->radius)
            off = &cut->off_dart;
    }
    *off = fmax(*off, distance / cut->h);
}

/* Both ways, as one may lie along the other without reaching its ends. */
static void compare(struct cut *cut, const struct measure *b)
{
    const double(*x)[2] = (const double(*)[2])b->border->outline->x;
    const double(*y)[2] = (const double(*)[2])cut->x;
    const int32_t(*end)[2] = (const int32_t(*)[2])b->end;
    for (int k = 0; k < 2 * b->border->outline->n; k++) {
        const double *a = x[k / 2], *c = x[k / 2 + k % 2];
        double p[2] = {(a[0] + c[0]) / 2, (a[1] + c[1]) / 2};
        count(cut, b, p, nearest(&b->cells, y, end, p));
    }
    for (int k = 0; k < 2 * b->ends; k++) {
        const double *a = y[end[k / 2][0]], *c = y[end[k / 2][k % 2]];
        double p[2] = {(a[0] + c[0]) / 2, (a[1] + c[1]) / 2};
        count(cut, b, p, nearest(&b->border->chords, x, NULL, p));
    }
}

static double area_of(const struct cut *cut)
{
    double sum = 0;
    for (int64_t c = 0; c < (int64_t)(cut->m - 1) * (cut->n - 1); c++) {
        int32_t tri[2][3];
        for (int k = cut_triangles(cut, c, tri) - 1; k >= 0; k--) {
            const double *x = cut->x[tri[k][0]], *y = cut->x[tri[k][1]];
            const double *z = cut->x[tri[k][2]];
            sum +=
                (y[0] - x[0]) * (z[1] - x[1]) - (y[1] - x[1]) * (z[0] - x[0]);
        }
    }
    return sum / 2;
}

bool cut_measure(struct cut *cut, const struct border *border)
{
    struct measure b = {.cut = cut, .border = border};
    cut->area = area_of(cut);
    find_border(&b);
    struct tip *tip =
        malloc(((size_t)border->outline->edges + 1) * sizeof *tip);
    int32_t(*end)[2] = malloc(((size_t)b.ends + 1) * sizeof *end);
    b.tip = tip;
    b.end = end;
    bool good = tip && end;
    if (good) {
        find_tips(&b);
        b.ends = 0;
        find_border(&b);
        good = buckets_make(&b.cells, (const double(*)[2])cut->x,
                            (const int32_t(*)[2])end, b.ends, cut->h);
    }
    if (good)
        compare(cut, &b);
    buckets_free(&b.cells);
    free(tip);
    free(end);
    return good;
}
