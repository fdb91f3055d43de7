/* SPDX-License-Identifier: Apache-2.0 */
/* The edges of a panel's outline: lines, Bézier curves, circular arcs and
 * polylines. */
#include "app/base/curve.h"

#include <math.h>
#include <string.h>

/* By how much a chord may be longer than the diameter. */
static const double slack = 1e-3;

bool curve_arc(struct curve *curve, double radius, bool large,
               bool counter_clockwise)
{
    double dx = curve->b[0] - curve->a[0], dy = curve->b[1] - curve->a[1];
    double chord = plane_length(dx, dy);
    if (!(radius > 0) || !(chord <= 2 * radius * (1 + slack)))
        return false;
    double sine = chord / (2 * radius);
    double half = asin(sine < 1 ? sine : 1);
    if (large)
        half = acos(-1) - half;
    /* Seen along the chord, the centre of a counter-clockwise arc is on the
     * left unless the arc is the large one. */
    double side = large == counter_clockwise ? -1 : 1;
    double away = side * sqrt(fmax(radius * radius - chord * chord / 4, 0));
    curve->type = CURVE_ARC;
    curve->c[0] = (curve->a[0] + curve->b[0]) / 2 - away * dy / chord;
    curve->c[1] = (curve->a[1] + curve->b[1]) / 2 + away * dx / chord;
    curve->turn = counter_clockwise ? 2 * half : -2 * half;
    return true;
}

static void swap(double a[2], double b[2])
{
    double c[2];
    memcpy(c, a, sizeof c);
    memcpy(a, b, sizeof c);
    memcpy(b, c, sizeof c);
}

void curve_reverse(struct curve *curve)
{
    swap(curve->a, curve->b);
    if (curve->type == CURVE_CUBIC)
        swap(curve->c, curve->d);
    curve->turn = -curve->turn;
    curve->back = !curve->back;
}

const double *curve_corner(const struct curve *curve, int k)
{
    if (k <= 0 || k > curve->points)
        return k <= 0 ? curve->a : curve->b;
    return curve->point[curve->back ? curve->points - k : k - 1];
}

/* The length of a polyline from corner k to the next. */
static double side_of(const struct curve *curve, int k)
{
    const double *a = curve_corner(curve, k), *b = curve_corner(curve, k + 1);
    return plane_length(b[0] - a[0], b[1] - a[1]);
}

/* The point of a Bézier curve, and its derivative by t. */
static void bezier(const struct curve *curve, double t, double x[2],
                   double dx[2])
{
    double s = 1 - t;
    for (int i = 0; i < 2; i++) {
        double a = curve->a[i], b = curve->b[i];
        double c = curve->c[i], d = curve->d[i];
        if (curve->type == CURVE_LINE) {
            x[i] = s * a + t * b;
            dx[i] = b - a;
        } else if (curve->type == CURVE_QUADRATIC) {
            x[i] = s * s * a + 2 * s * t * c + t * t * b;
            dx[i] = 2 * (s * (c - a) + t * (b - c));
        } else {
            x[i] = s * s * s * a + 3 * s * s * t * c + 3 * s * t * t * d +
                   t * t * t * b;
            dx[i] =
                3 * (s * s * (c - a) + 2 * s * t * (d - c) + t * t * (b - d));
        }
    }
}

void curve_point(const struct curve *curve, double t, double x[2])
{
    double unused[2];
    if (t <= 0 || t >= 1) {
        memcpy(x, t <= 0 ? curve->a : curve->b, sizeof curve->a);
    } else if (curve->type == CURVE_POLYLINE) {
        double at = t * (curve->points + 1);
        int k = (int)at < curve->points ? (int)at : curve->points;
        const double *a = curve_corner(curve, k);
        const double *b = curve_corner(curve, k + 1);
        for (int i = 0; i < 2; i++)
            x[i] = a[i] + (at - k) * (b[i] - a[i]);
    } else if (curve->type == CURVE_ARC) {
        double dx = curve->a[0] - curve->c[0], dy = curve->a[1] - curve->c[1];
        double cosine = cos(t * curve->turn), sine = sin(t * curve->turn);
        x[0] = curve->c[0] + cosine * dx - sine * dy;
        x[1] = curve->c[1] + sine * dx + cosine * dy;
    } else {
        bezier(curve, t, x, unused);
    }
}

/* Gauss's rule of five points on 0 … 1, exact for polynomials of degree 9. */
static const double at[5] = {0.046910077030668, 0.230765344947158, 0.5,
                             0.769234655052842, 0.953089922969332};
static const double weight[5] = {0.118463442528095, 0.239314335249683,
                                 0.284444444444444, 0.239314335249683,
                                 0.118463442528095};

static double radius_of(const struct curve *arc)
{
    return plane_length(arc->a[0] - arc->c[0], arc->a[1] - arc->c[1]);
}

double curve_length(const struct curve *curve)
{
    enum { PARTS = 32 };
    double sum = 0, x[2], dx[2];
    if (curve->type == CURVE_LINE)
        return plane_length(curve->b[0] - curve->a[0],
                            curve->b[1] - curve->a[1]);
    if (curve->type == CURVE_ARC)
        return radius_of(curve) * fabs(curve->turn);
    if (curve->type == CURVE_POLYLINE) {
        for (int k = 0; k <= curve->points; k++)
            sum += side_of(curve, k);
        return sum;
    }
    for (int k = 0; k < 5 * PARTS; k++) {
        bezier(curve, (k / 5 + at[k % 5]) / PARTS, x, dx);
        sum += weight[k % 5] * plane_length(dx[0], dx[1]) / PARTS;
    }
    return sum;
}

double curve_area(const struct curve *curve)
{
    double sum = 0, x[2], dx[2];
    if (curve->type == CURVE_ARC) {
        double radius = radius_of(curve);
        return (radius * radius * curve->turn +
                curve->c[0] * (curve->b[1] - curve->a[1]) -
                curve->c[1] * (curve->b[0] - curve->a[0])) /
               2;
    }
    if (curve->type == CURVE_POLYLINE) {
        for (int k = 0; k <= curve->points; k++) {
            const double *a = curve_corner(curve, k);
            const double *b = curve_corner(curve, k + 1);
            sum += (a[0] * b[1] - a[1] * b[0]) / 2;
        }
        return sum;
    }
    for (int k = 0; k < 5; k++) {
        bezier(curve, at[k], x, dx);
        sum += weight[k] * (x[0] * dx[1] - x[1] * dx[0]) / 2;
    }
    return sum;
}

/* The largest second derivative by t; of an arc, radius × angle². */
static double largest_bend(const struct curve *curve)
{
    const double *a = curve->a, *b = curve->b, *c = curve->c, *d = curve->d;
    if (curve->type == CURVE_LINE)
        return 0;
    if (curve->type == CURVE_ARC)
        return radius_of(curve) * curve->turn * curve->turn;
    if (curve->type == CURVE_QUADRATIC)
        return 2 * plane_length(a[0] - 2 * c[0] + b[0], a[1] - 2 * c[1] + b[1]);
    return 6 *
           fmax(plane_length(a[0] - 2 * c[0] + d[0], a[1] - 2 * c[1] + d[1]),
                plane_length(c[0] - 2 * d[0] + b[0], c[1] - 2 * d[1] + b[1]));
}

int curve_chords(const struct curve *curve, double error, double longest)
{
    if (curve->type == CURVE_POLYLINE) {
        /* each side of it has the same number, so that corners are kept */
        double most = 0;
        for (int k = 0; k <= curve->points; k++)
            most = fmax(most, side_of(curve, k));
        double each = fmax(ceil(most / longest), 1);
        return (int)fmin(each * (curve->points + 1), CURVE_CHORDS);
    }
    /* A chord over a step δ of t is off by at most |second derivative| δ²/8. */
    double by_error = sqrt(largest_bend(curve) / (8 * error));
    double by_length = curve_length(curve) / longest;
    double count = ceil(fmax(by_error, by_length));
    if (!(count <= CURVE_CHORDS))
        return CURVE_CHORDS;
    return count > 1 ? (int)count : 1;
}
