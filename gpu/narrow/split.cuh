/* SPDX-License-Identifier: Apache-2.0 */
/* Tier 2 of the narrow phase on the device: subdivides [0, 1] in binary64.
 * spec/narrow/narrow.md §5 */
#ifndef GPU_SPLIT_CUH
#define GPU_SPLIT_CUH

#include "gpu/narrow/filter.cuh"

extern "C" {
#include "ref/narrow/narrow.h"
}

enum { SPLIT_MISS, SPLIT_HIT, SPLIT_UNSURE };
enum { SPLIT_GRID = 30, SPLIT_DEPTH = 20, SPLIT_VISITS = 64 };

/* The polynomials of a pair for tier 2, §2: always four forms and four box
 * forms. */
struct forms {
    double v[4];         /* the cubic V */
    double w[3][4][3];   /* on axis k, form j, coefficient i */
    double box[3][4][2]; /* on axis k, box form j, at t = 0 and 1 */
    struct errors e;
    double e_box[3];
};

/* Sets the box forms of one time, on all axes. */
static __device__ inline void set_boxes(const struct quad *p, int t,
                                        struct forms *s)
{
    const vec *x = p->x[t];
    double d[4][3];
    difference(p->ee ? x[2] : x[1], x[0], d[0]);
    difference(p->ee ? x[3] : x[2], x[0], d[1]);
    difference(p->ee ? x[2] : x[3], p->ee ? x[1] : x[0], d[2]);
    difference(x[3], p->ee ? x[1] : x[0], d[3]);
    for (int k = 0; k < 3; k++)
        for (int j = 0; j < 4; j++)
            s->box[k][j][t] = d[j][k];
}

/* Makes the polynomials. Returns false where the inputs are beyond the range of
 * the proofs. */
static __device__ inline bool make_forms(const struct quad *p, struct forms *s)
{
    struct vectors m = vectors_of(p);
    double n[3][3];
    if (!errors_of(&m, &s->e))
        return false;
    set_boxes(p, 0, s);
    set_boxes(p, 1, s);
    for (int k = 0; k < 3; k++) {
        double size = 0;
        for (int j = 0; j < 4; j++)
            size = max_of(size,
                          max_of(fabs(s->box[k][j][0]), fabs(s->box[k][j][1])));
        s->e_box[k] = ERROR_BOX * size + UNDERFLOW;
        cross_form(m.g, m.h, k, n[k]);
        axis_forms(&m, p->ee, k, n[k], s->w[k]);
    }
    cubic_form(m.f, n, s->v);
    return true;
}

static __device__ inline double mix(double a, double b, double t)
{
    return (1 - t) * a + t * b;
}

/* §5.1: Bernstein forms on [a, b]. */

static __device__ inline void restrict_form(const double c[3], double a,
                                            double b, double r[3])
{
    double p = mix(c[0], c[1], a), q = mix(c[1], c[2], a);
    r[0] = mix(p, q, a);
    r[1] = mix(p, q, b);
    r[2] = mix(mix(c[0], c[1], b), mix(c[1], c[2], b), b);
}

static __device__ inline void restrict_cubic(const double c[4], double a,
                                             double b, double r[4])
{
    double p[3], q[3];
    for (int i = 0; i < 3; i++) {
        p[i] = mix(c[i], c[i + 1], a);
        q[i] = mix(c[i], c[i + 1], b);
    }
    restrict_form(p, a, b, r);
    r[3] = mix(mix(q[0], q[1], b), mix(q[1], q[2], b), b);
}

static __device__ inline double cubic_at(const double c[4], double t)
{
    double p = mix(c[0], c[1], t), q = mix(c[1], c[2], t);
    double r = mix(c[2], c[3], t);
    return mix(mix(p, q, t), mix(q, r, t), t);
}

/* §5.2: whether the box forms prove on some axis that [a, b] has no contact. */
static __device__ inline bool apart_on(const struct forms *s, double a,
                                       double b)
{
    bool apart = false;
    for (int k = 0; k < 3; k++) {
        bool up = true, down = true;
        for (int j = 0; j < 4; j++) {
            const double *c = s->box[k][j];
            double p = mix(c[0], c[1], a), q = mix(c[0], c[1], b);
            up = up && min_of(p, q) > s->e_box[k];
            down = down && max_of(p, q) < -s->e_box[k];
        }
        apart = apart || up || down;
    }
    return apart;
}

/* §5.2: tests the forms on [a, b]. Returns -1 where there is no contact in [a,
 * b], 1 where every root of V in [a, b] is a contact, and 0 where neither is
 * certain. */
static __device__ inline int touching_on(const struct forms *s, double a,
                                         double b)
{
    int sure = 0;
    for (int k = 0; k < 3; k++) {
        int up = 0, down = 0;
        for (int j = 0; j < 4; j++) {
            double c[3];
            restrict_form(s->w[k][j], a, b, c);
            int sign = certain(c, s->e.q[k]);
            up += sign > 0;
            down += sign < 0;
        }
        if (up && down)
            return -1;
        if (up == 4 || down == 4)
            sure = 1;
    }
    return sure;
}

/* §5.3: roots of V. */

enum { ROOTS_NONE, ROOTS_ONE, ROOTS_UNKNOWN };

static __device__ inline int roots_on(const struct forms *s, double a, double b)
{
    double c[4], e = s->e.v;
    restrict_cubic(s->v, a, b, c);
    if (certain_cubic(c, e))
        return ROOTS_NONE;
    bool falls = c[0] > e && c[3] < -e && (c[1] > e || c[2] < -e);
    bool rises = c[0] < -e && c[3] > e && (c[1] < -e || c[2] > e);
    return falls || rises ? ROOTS_ONE : ROOTS_UNKNOWN;
}

/* Bisects [lo, hi], which holds one root of V, to the root's cell. Returns
 * false where a sign of V is uncertain. */
static __device__ inline bool locate_on(const struct forms *s, uint32_t lo,
                                        uint32_t hi, uint32_t *cell)
{
    bool rising = cubic_at(s->v, lo * 0x1p-30) < 0;
    while (hi - lo > 1) {
        uint32_t middle = lo + (hi - lo) / 2;
        double v = cubic_at(s->v, middle * 0x1p-30);
        if (!(v > s->e.v || v < -s->e.v))
            return false;
        if ((v < 0) == rising)
            lo = middle;
        else
            hi = middle;
    }
    *cell = lo;
    return true;
}

/* Tests one interval. SPLIT_MISS: the interval is done, without contact.
 * SPLIT_HIT: *toi is the answer. SPLIT_UNSURE: the interval must be halved, or
 * if *stuck is set, tier 3 must decide the pair. */
static __device__ inline int test_interval(const struct forms *s, uint32_t lo,
                                           uint32_t hi, uint32_t *toi,
                                           bool *stuck)
{
    double a = lo * 0x1p-30, b = hi * 0x1p-30;
    int r = roots_on(s, a, b), inside = 0;
    *stuck = false;
    if (r == ROOTS_NONE || apart_on(s, a, b))
        return SPLIT_MISS;
    inside = touching_on(s, a, b);
    if (inside < 0)
        return SPLIT_MISS;
    if (r == ROOTS_UNKNOWN)
        return SPLIT_UNSURE;
    *stuck = true;
    if (!locate_on(s, lo, hi, toi))
        return SPLIT_UNSURE;
    if (!inside)
        inside = touching_on(s, *toi * 0x1p-30, (*toi + 1) * 0x1p-30);
    return inside > 0 ? SPLIT_HIT : inside < 0 ? SPLIT_MISS : SPLIT_UNSURE;
}

/* Runs tier 2 (§5). Returns SPLIT_HIT with the exact *toi, SPLIT_MISS, or
 * SPLIT_UNSURE. */
static __device__ inline int split(const struct forms *s, uint32_t *toi)
{
    uint32_t i = 0;
    int d = 0;
    for (int visit = 0; visit < SPLIT_VISITS; visit++) {
        uint32_t lo = i << (SPLIT_GRID - d), hi = (i + 1) << (SPLIT_GRID - d);
        bool stuck;
        int end = test_interval(s, lo, hi, toi, &stuck);
        if (end == SPLIT_HIT)
            return SPLIT_HIT;
        if (end == SPLIT_UNSURE) {
            if (stuck || d == SPLIT_DEPTH)
                return SPLIT_UNSURE;
            i *= 2;
            d++;
            continue;
        }
        for (i++; d > 0 && !(i & 1); d--)
            i >>= 1;
        if (d == 0)
            return SPLIT_MISS;
    }
    return SPLIT_UNSURE;
}

#endif
