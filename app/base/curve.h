/* SPDX-License-Identifier: Apache-2.0 */
/* The edges of a panel's outline in the plane: lines, Bézier curves, circular
 * arcs and polylines. Pure geometry: app/patterns/README.md §2. */
#ifndef APP_BASE_CURVE_H
#define APP_BASE_CURVE_H

#include <math.h>
#include <stdbool.h>

enum curve_type {
    CURVE_LINE,
    CURVE_QUADRATIC,
    CURVE_CUBIC,
    CURVE_ARC,
    CURVE_POLYLINE
};

struct curve {
    enum curve_type type;
    double a[2], b[2];  /* where it begins and ends, m */
    double c[2], d[2];  /* control points; of an arc, c is its centre */
    double turn;        /* of an arc: its angle, counter-clockwise, rad */
    int points;         /* of a polyline, between its ends */
    double (*point)[2]; /* [points] m, the caller's */
    bool back;          /* the points are passed from the last to the first */
};

/* √(x² + y²). hypot would ask for glibc 2.35 at run time. */
static inline double plane_length(double x, double y)
{
    return sqrt(x * x + y * y);
}

/* Makes the curve an arc from a to b, which are not the same point. The ends
 * of a circle's diameter may be apart by a thousandth more than the diameter,
 * as rounding leaves them. false: the radius is too small. */
bool curve_arc(struct curve *curve, double radius, bool large,
               bool counter_clockwise);
/* Exchanges its ends. */
void curve_reverse(struct curve *curve);

/* The point at t, 0 … 1. */
void curve_point(const struct curve *curve, double t, double x[2]);
double curve_length(const struct curve *curve);
/* The area that the ray from the origin to the point sweeps from a to b,
 * counter-clockwise positive. The sum over a closed outline is its area. */
double curve_area(const struct curve *curve);
/* The number of chords, of equal steps of t, that stay within `error` of the
 * curve and are at most about `longest`. 1 … CURVE_CHORDS. */
enum { CURVE_CHORDS = 1 << 20 };
int curve_chords(const struct curve *curve, double error, double longest);
/* Corner k of a polyline, 0 … points + 1, its ends among them. Steps of t are
 * the same from corner to corner. */
const double *curve_corner(const struct curve *curve, int k);

#endif
