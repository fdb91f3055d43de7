/* SPDX-License-Identifier: Apache-2.0 */
/* Curves along which a hung or rolled cloth starts. Neighbouring points are one
 * cell apart, so that the cloth starts without strain. */
#include "app/scene/shapes.h"

/* Parameters of one curve and its point at t; t grows along the curve. */
struct curve {
    void (*point)(const struct curve *curve, double t, double p[2]);
    double wave, depth; /* a sine: its wavelength and amplitude, m */
    double radius, gap; /* a spiral: at t = 0, and a turn further out, m */
};

static void sine(const struct curve *curve, double t, double p[2])
{
    double c, s;
    circle(t / curve->wave, &c, &s);
    p[0] = t;
    p[1] = curve->depth * s;
}

/* t in turns. */
static void spiral(const struct curve *curve, double t, double p[2])
{
    double c, s, r = curve->radius + curve->gap * t;
    circle(t, &c, &s);
    p[0] = r * c;
    p[1] = r * s;
}

static double distance(const double a[2], const double b[2])
{
    double x = a[0] - b[0], y = a[1] - b[1];
    return square_root(x * x + y * y);
}

/* Returns the first t after `from` at distance h from p, by bisection within
 * `reach`, in which the distance grows to h or more. */
static double advance(const struct curve *curve, const double p[2], double from,
                      double reach, double h)
{
    double lo = from, hi = from + reach, q[2];
    for (int k = 0; k < 60; k++) {
        double middle = lo + (hi - lo) / 2;
        curve->point(curve, middle, q);
        if (distance(p, q) < h)
            lo = middle;
        else
            hi = middle;
    }
    return hi;
}

/* Returns the length of one wave of a sine, by short chords. */
static double wave_length(const struct curve *curve)
{
    enum { CHORDS = 512 };
    double sum = 0, a[2], b[2];
    sine(curve, 0, a);
    for (int k = 1; k <= CHORDS; k++) {
        sine(curve, curve->wave * k / CHORDS, b);
        sum += distance(a, b);
        a[0] = b[0];
        a[1] = b[1];
    }
    return sum;
}

/* Sets the wavelength at which one wave takes `length` of cloth. False if there
 * is none. */
static bool fit_wave(struct curve *curve, double length)
{
    if (!(4.2 * curve->depth < length))
        return false;
    double lo = 0, hi = length;
    for (int k = 0; k < 60; k++) {
        curve->wave = lo + (hi - lo) / 2;
        if (wave_length(curve) < length)
            lo = curve->wave;
        else
            hi = curve->wave;
    }
    curve->wave = hi;
    return true;
}

bool start_curve(const struct start *start, int m, double h, double (*out)[2])
{
    struct curve curve = {
        .depth = start->depth, .radius = start->radius, .gap = start->gap};
    bool rolled = start->shape == START_ROLLED;
    curve.point = rolled ? spiral : sine;
    if (!rolled && !fit_wave(&curve, h * (m - 1) / start->folds))
        return false;
    double t = 0;
    curve.point(&curve, t, out[0]);
    for (int i = 1; i < m; i++) {
        /* A spiral's chord of half a turn is longer than its radius. */
        double reach = rolled ? 0.5 : 1.001 * h;
        t = advance(&curve, out[i - 1], t, reach, h);
        curve.point(&curve, t, out[i]);
    }
    /* the middle of the hung edge is at the start's place */
    double shift = rolled ? 0 : t / 2;
    for (int i = 0; i < m; i++)
        out[i][0] -= shift;
    return !rolled || h < start->radius;
}
