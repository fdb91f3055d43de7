/* SPDX-License-Identifier: Apache-2.0 */
/* Segments of the plane, sorted by the squares of a grid. */
#include "app/base/outline.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Squares an axis: a fine grid over a large box would be mostly empty. */
enum { SQUARES = 1 << 11 };

int bucket_of(const struct buckets *buckets, int axis, double x)
{
    int last = (axis ? buckets->n : buckets->m) - 1;
    double k = floor((x - buckets->at[axis]) / buckets->size);
    if (!(k > 0))
        return 0;
    return k < last ? (int)k : last;
}

/* The squares that a segment's box meets: from lo to hi. */
static void span(const struct buckets *buckets, const double a[2],
                 const double b[2], int lo[2], int hi[2])
{
    for (int i = 0; i < 2; i++) {
        lo[i] = bucket_of(buckets, i, fmin(a[i], b[i]));
        hi[i] = bucket_of(buckets, i, fmax(a[i], b[i]));
    }
}

/* Counts the segments of each square, or, where item is there, puts them. */
static void sort_in(struct buckets *buckets, const double (*x)[2],
                    const int32_t (*end)[2], int count)
{
    int lo[2], hi[2];
    for (int k = 0; k < count; k++) {
        span(buckets, x[end ? end[k][0] : k], x[end ? end[k][1] : k + 1], lo,
             hi);
        for (int j = lo[1]; j <= hi[1]; j++)
            for (int i = lo[0]; i <= hi[0]; i++) {
                int64_t *first = &buckets->first[i + (int64_t)buckets->m * j];
                if (buckets->item)
                    buckets->item[--*first] = k;
                else
                    ++*first;
            }
    }
}

bool buckets_make(struct buckets *buckets, const double (*x)[2],
                  const int32_t (*end)[2], int count, double size)
{
    double lo[2] = {INFINITY, INFINITY}, hi[2] = {-INFINITY, -INFINITY};
    for (int k = 0; k < 2 * count; k++) {
        const double *p = x[end ? end[k / 2][k % 2] : k / 2 + k % 2];
        for (int i = 0; i < 2; i++) {
            lo[i] = fmin(lo[i], p[i]);
            hi[i] = fmax(hi[i], p[i]);
        }
    }
    double wide = fmax(hi[0] - lo[0], hi[1] - lo[1]);
    *buckets = (struct buckets){.at = {lo[0], lo[1]},
                                .size = fmax(size, wide / SQUARES)};
    buckets->m = 1 + (int)floor((hi[0] - lo[0]) / buckets->size);
    buckets->n = 1 + (int)floor((hi[1] - lo[1]) / buckets->size);
    size_t squares = (size_t)buckets->m * (size_t)buckets->n;
    buckets->first = calloc(squares + 1, sizeof *buckets->first);
    if (!buckets->first)
        return false;
    sort_in(buckets, x, end, count);
    for (size_t k = 1; k <= squares; k++)
        buckets->first[k] += buckets->first[k - 1];
    buckets->item =
        malloc(((size_t)buckets->first[squares] + 1) * sizeof *buckets->item);
    if (buckets->item)
        sort_in(buckets, x, end, count);
    else
        buckets_free(buckets);
    return buckets->item;
}

void buckets_free(struct buckets *buckets)
{
    free(buckets->first);
    free(buckets->item);
    memset(buckets, 0, sizeof *buckets);
}

double segment_distance(const double x[2], const double a[2], const double b[2],
                        double near[2])
{
    double d[2] = {b[0] - a[0], b[1] - a[1]};
    double length = d[0] * d[0] + d[1] * d[1];
    double t = (x[0] - a[0]) * d[0] + (x[1] - a[1]) * d[1];
    t = length > 0 ? t / length : 0;
    t = t < 0 ? 0 : t > 1 ? 1 : t;
    near[0] = a[0] + t * d[0];
    near[1] = a[1] + t * d[1];
    return plane_length(x[0] - near[0], x[1] - near[1]);
}
