/* SPDX-License-Identifier: Apache-2.0 */
/* The force law of a spring: its tension, the slope of the tension, and its
 * energy, as functions of the length. spec/cloth/cloth.md §5, after Choi–Ko
 * 2002 §4. */
#ifndef REF_LAW_H
#define REF_LAW_H

#include "ref/cloth/cloth.h"

/* §5: g(q) = P(t) / s with s = √(q + LAW_SHIFT), t = s − 25/32. */
#define LAW_SHIFT 0.21723362821122166
#define LAW_MIDDLE 0.78125
/* §5: -g' ≤ 119 on [0, 1]. */
#define LAW_STEEPEST 119

static inline real law_s(real q)
{
    return real_sqrt(q + R(LAW_SHIFT));
}

/* P(t) by Horner's rule. */
static inline real law_p(real t)
{
    real r = R(0.94535780075);
    r = r * t - R(1.41489955139);
    r = r * t + R(1.94328409844);
    r = r * t - R(2.96088097053);
    r = r * t + R(4.67227098415);
    r = r * t - R(7.81897177916);
    return r * t + R(15.3546581234);
}

/* dP/dt. */
static inline real law_dp(real t)
{
    real r = R(5.6721468045);
    r = r * t - R(7.07449775695);
    r = r * t + R(7.77313639376);
    r = r * t - R(8.88264291159);
    r = r * t + R(9.3445419683);
    return r * t - R(7.81897177916);
}

/* ∫ P dt from 0. */
static inline real law_ip(real t)
{
    real r = R(0.13505111439285714);
    r = r * t - R(0.23581659189833333);
    r = r * t + R(0.388656819688);
    r = r * t - R(0.7402202426325);
    r = r * t + R(1.5574236613833333);
    r = r * t - R(3.90948588958);
    r = r * t + R(15.3546581234);
    return r * t;
}

/* §5: the compressive force of a buckled spring of length q·rest, q in [0, 1],
 * divided by `bend`: 12 at q = 1, 4π² at q = 0. */
static inline real law_g(real q)
{
    real s = law_s(q);
    return law_p(s - R(LAW_MIDDLE)) / s;
}

/* §5: the knee of a double spring divided by its rest length: the largest root
 * of stiff·(q − 1) + g(q), stiff = compression·rest / bend; 0 if there is no
 * root. The function is convex, so Newton's method from q = 1 descends to that
 * root and never passes it. */
static inline real law_knee(real stiff)
{
    real q = 1;
    for (int k = 0; k < 40; k++) {
        real s = law_s(q), t = s - R(LAW_MIDDLE), g = law_p(t) / s;
        real slope = stiff - (g - law_dp(t)) / (2 * s * s);
        real next = slope > 0 ? q - (stiff * (q - 1) + g) / slope : -1;
        if (!(next > 0))
            return 0;
        q = real_min(next, 1);
    }
    return q;
}

/* Sets knee and well from the other members. two: a double spring. */
static inline void law_set_knee(struct law *a, bool two)
{
    a->knee = a->well = 0;
    if (!two)
        return;
    real part = 1;
    if (a->bend > 0)
        part = law_knee(a->compression * a->rest / a->bend);
    a->knee = a->rest * part;
    real d = a->knee - a->rest, t = law_s(part) - R(LAW_MIDDLE);
    a->well =
        R(0.5) * a->compression * d * d + a->bend * a->rest * (2 * law_ip(t));
}

/* §8: a single spring stiffens from LIMIT_FROM of its limit on. Its slope grows
 * up to LIMIT_TO of the limit, where it has LIMIT_PULL k·rest of tension more
 * than k alone gives. */
#define LIMIT_FROM 0.75
#define LIMIT_TO 1.1
#define LIMIT_PULL 6

/* Sets from, limit, over and gain, and raises stiff. limit: the strain; 0:
 * none. */
static inline void law_set_limit(struct law *a, double limit)
{
    double rest = (double)a->rest, k = (double)a->k;
    a->from = a->limit = (real)INFINITY;
    a->over = a->gain = 0;
    if (!(limit > 0))
        return;
    double over = (LIMIT_TO - LIMIT_FROM) * limit * rest;
    double gain = LIMIT_PULL * k * rest / (over * over);
    a->from = a->limit = (real)(rest * (1 + LIMIT_FROM * limit));
    a->over = (real)over;
    a->gain = (real)gain;
    a->stiff = real_max(a->stiff, (real)(k + 2 * gain * over));
}

/* §8: the tension, N, the slope, N/m, and the energy, J, that a spring longer
 * than `limit` has in addition. w: how far its slope has grown. */
static inline real law_more(const struct law *a, real length)
{
    real e = length - a->limit, w = real_min(e, a->over);
    return a->gain * w * (e + (e - w));
}

static inline real law_more_slope(const struct law *a, real length)
{
    return 2 * (a->gain * real_min(length - a->limit, a->over));
}

static inline real law_more_energy(const struct law *a, real length)
{
    real e = length - a->limit, w = real_min(e, a->over);
    return a->gain * w * (w * w / 3 + e * (e - w));
}

/* §9: the piece that holds for a length above rest, of a law that has some. */
static inline struct piece law_piece(const struct law *a, const struct piece *t,
                                     real length)
{
    struct piece found = t[a->first];
    for (int32_t k = 1; k < a->pieces; k++)
        if (length > t[a->first + k].from)
            found = t[a->first + k];
    return found;
}

/* Tension, slope and energy of a spring that is longer than `from`. */
static inline real law_long(const struct law *a, const struct piece *t,
                            real length)
{
    real f = a->k * (length - a->rest);
    if (a->pieces > 0) {
        struct piece is = law_piece(a, t, length);
        f = is.pull + is.slope * (length - is.from);
    }
    return length > a->limit ? f + law_more(a, length) : f;
}

static inline real law_long_slope(const struct law *a, const struct piece *t,
                                  real length)
{
    real slope = a->pieces > 0 ? law_piece(a, t, length).slope : a->k;
    return length > a->limit ? slope + law_more_slope(a, length) : slope;
}

static inline real law_long_energy(const struct law *a, const struct piece *t,
                                   real length)
{
    real d = length - a->rest, work = R(0.5) * a->k * d * d;
    if (a->pieces > 0) {
        struct piece is = law_piece(a, t, length);
        real e = length - is.from;
        work = is.work + e * (is.pull + R(0.5) * is.slope * e);
    }
    return length > a->limit ? work + law_more_energy(a, length) : work;
}

/* The spring constant, N/m, of a spring that is not buckled. */
static inline real law_constant(const struct law *a, real length)
{
    return length >= a->rest ? a->k : a->compression;
}

/* Tension, N, of a spring of the given length. t: the cloth's pieces, of which
 * the law may have some. */
static inline real law_tension(const struct law *a, const struct piece *t,
                               real length)
{
    if (length > a->from)
        return law_long(a, t, length);
    if (length >= a->knee)
        return law_constant(a, length) * (length - a->rest);
    return -(a->bend * law_g(length / a->rest));
}

/* Slope of the tension, N/m, in [0, stiff]. */
static inline real law_slope(const struct law *a, const struct piece *t,
                             real length)
{
    if (length > a->from)
        return law_long_slope(a, t, length);
    if (length >= a->knee)
        return law_constant(a, length);
    real s = law_s(length / a->rest), h = s - R(LAW_MIDDLE);
    real slope = (law_p(h) / s - law_dp(h)) / (2 * s * s);
    return a->bend * slope / a->rest;
}

/* Elastic energy, J, 0 at the rest length. Below the knee the spring is buckled
 * and has the energy of the bent arc of spec/cloth/cloth.md §5, whose constant
 * `well` makes the energy continuous at the knee. */
static inline real law_energy(const struct law *a, const struct piece *t,
                              real length)
{
    real d = length - a->rest;
    if (length > a->from)
        return law_long_energy(a, t, length);
    if (length >= a->knee)
        return R(0.5) * law_constant(a, length) * d * d;
    real h = law_s(length / a->rest) - R(LAW_MIDDLE);
    return a->well - a->bend * a->rest * (2 * law_ip(h));
}

#endif
