/* SPDX-License-Identifier: Apache-2.0 */
/* A closed outline as a polygon of chords, and what must hold of it before it
 * can be cut. Pure geometry: app/patterns/README.md §2, §3. */
#ifndef APP_BASE_OUTLINE_H
#define APP_BASE_OUTLINE_H

#include "app/base/curve.h"

#include <stdbool.h>
#include <stdint.h>

struct outline {
    int edges;
    const struct curve *edge; /* [edges] counter-clockwise, each begins where
                                 the one before ends */
    int n;                    /* chords */
    double (*x)[2];           /* [n + 1] chord k from x[k] to x[k + 1], m */
    int32_t *of;              /* [n] the edge of a chord */
    int32_t *first;           /* [edges + 1] the first chord of an edge */
    double *s;                /* [n + 1] length of the outline up to x[k], m */
    double lo[2], hi[2];      /* the box around it */
    double area;              /* that the curves enclose, m² */
};

/* Makes the chords, each within `error` of its curve and at most `longest`.
 * Where an edge does not begin where the one before ends, as an edge between
 * them is closed up, both are drawn to the middle, by less and less over four
 * times `longest`. false: no memory. outline_free gives back what it holds. */
bool outline_make(struct outline *outline, const struct curve *edge, int edges,
                  double error, double longest);
void outline_free(struct outline *outline);

/* Whether a point is on the right of a chord's line: beyond it, seen from the
 * panel, by more than rounding. */
bool outline_is_right(const struct outline *outline, int32_t chord,
                      const double x[2]);

/* Segments by the squares of a grid that their boxes meet. */
struct buckets {
    double at[2], size; /* m, the grid's corner and the squares' side */
    int m, n;
    int64_t *first; /* [m n + 1] */
    int32_t *item;  /* segments, by square */
};
/* Sorts the segments x[end[2k]], x[end[2k + 1]]; end NULL: x[k], x[k + 1]. The
 * squares are at least `size` wide. false: no memory. */
bool buckets_make(struct buckets *buckets, const double (*x)[2],
                  const int32_t (*end)[2], int count, double size);
void buckets_free(struct buckets *buckets);
/* The square that a coordinate lies in, within the grid. */
int bucket_of(const struct buckets *buckets, int axis, double x);

/* Distance of a point from the segment ab; near: out: the nearest point. */
double segment_distance(const double x[2], const double a[2], const double b[2],
                        double near[2]);

/* Whether a ray from x to the right crosses the segment ab. A closed outline is
 * around a point whose ray crosses an odd number of its chords. */
bool segment_meets_ray(const double x[2], const double a[2], const double b[2]);

/* Whether the segments ab and cd have a point in common. */
bool segments_meet(const double a[2], const double b[2], const double c[2],
                   const double d[2]);

/* Two places of an outline that meet or come near each other. */
struct outline_pair {
    int edge[2];
    double x[2];  /* where, m */
    double width; /* m */
};
enum outline_answer { OUTLINE_NO, OUTLINE_YES, OUTLINE_MEMORY };

/* Whether the outline crosses or touches itself, and where. */
enum outline_answer outline_crosses(const struct outline *outline,
                                    struct outline_pair *pair);
/* The narrowest strap of the panel, and the narrowest gap between two parts of
 * it, below `width`: where two stretches of the outline face each other within
 * a few degrees. Where two edges meet in a corner is neither.
 * strap, gap: width is INFINITY where there is none. */
enum outline_answer outline_narrow(const struct outline *outline, double width,
                                   struct outline_pair *strap,
                                   struct outline_pair *gap);

#endif
