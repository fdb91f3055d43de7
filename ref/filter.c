/* SPDX-License-Identifier: Apache-2.0 */
/* Binary64 filters with proven bounds: spec/30_narrow.md §4 and §5. */
#include "ref/filter.h"

#include "ref/real.h"

/* §4.3; proven in spec/proofs/narrow_*.gappa. δ is the largest component on an axis. */
#define ERROR_FORM 0x1p-47  /* times δiδj */
#define ERROR_CUBIC 0x1p-45 /* times δxδyδz */
#define ERROR_BOX 0x1p-51   /* times the largest box form */
#define UNDERFLOW 0x1p-800  /* what products below 2^-1022 can lose */
#define RANGE 0x1p200       /* the largest δ that the proof covers */

#define GRID 30        /* contact times are multiples of 2^-GRID */
#define DEPTH_LIMIT 20 /* levels of halving in the second tier */
#define VISIT_LIMIT 64 /* intervals that the second tier looks at */

/* Which of NONE, ONE root or UNKNOWN an interval holds. */
enum { NONE, ONE, UNKNOWN };

static double larger(double a, double b)
{
    return a > b ? a : b;
}
static double smaller(double a, double b)
{
    return a < b ? a : b;
}
static double size(double a)
{
    return a < 0 ? -a : a;
}

static void subtract(const double a[3], const double b[3], double c[3])
{
    for (int k = 0; k < 3; k++)
        c[k] = a[k] - b[k];
}

void motion_vf(double x[2][4][3], struct motion *m)
{
    m->count = 3;
    for (int j = 0; j < 3; j++)
        for (int t = 0; t < 2; t++) {
            subtract(x[t][j + 1], x[t][0], m->f[j].at[t]);
            memcpy(m->box[j].at[t], m->f[j].at[t], sizeof m->f[j].at[t]);
        }
}

void motion_ee(double x[2][4][3], struct motion *m)
{
    m->count = 4;
    for (int t = 0; t < 2; t++) {
        subtract(x[t][2], x[t][0], m->f[0].at[t]);
        subtract(x[t][1], x[t][0], m->f[1].at[t]);
        subtract(x[t][3], x[t][2], m->f[2].at[t]);
        subtract(x[t][2], x[t][0], m->box[0].at[t]);
        subtract(x[t][3], x[t][0], m->box[1].at[t]);
        subtract(x[t][2], x[t][1], m->box[2].at[t]);
        subtract(x[t][3], x[t][1], m->box[3].at[t]);
    }
}

/* Whether on axis k all box forms keep one strict sign (§4.1). The sign of
 * a rounded difference is exact. Gives the largest magnitude. */
static bool apart(const struct motion *m, int k, double *most)
{
    double lo = m->box[0].at[0][k], hi = lo;
    for (int j = 0; j < m->count; j++)
        for (int t = 0; t < 2; t++) {
            lo = smaller(lo, m->box[j].at[t][k]);
            hi = larger(hi, m->box[j].at[t][k]);
        }
    *most = larger(-lo, hi);
    return lo > 0 || hi < 0;
}

/* Axis k of a × b, Bernstein form. */
static void cross(const struct linear *f, const struct linear *g, int k,
                  double c[3])
{
    const double *a0 = f->at[0], *a1 = f->at[1], *b0 = g->at[0], *b1 = g->at[1];
    int i = k == 2 ? 0 : k + 1, j = 3 - k - i;
    c[0] = a0[i] * b0[j] - a0[j] * b0[i];
    c[1] = ((a0[i] * b1[j] - a0[j] * b1[i]) + (a1[i] * b0[j] - a1[j] * b0[i])) *
           0.5;
    c[2] = a1[i] * b1[j] - a1[j] * b1[i];
}

static double dot(const double a[3], const struct forms *s, int i)
{
    return a[0] * s->q[0][0][i] + a[1] * s->q[0][1][i] + a[2] * s->q[0][2][i];
}

/* V = f · (g × h); the cross product stands in s->q[0]. */
static void cubic(const struct linear *f, struct forms *s)
{
    const double *a = f->at[0], *b = f->at[1];
    s->v[0] = dot(a, s, 0);
    s->v[1] = (dot(b, s, 0) + 2 * dot(a, s, 1)) / 3;
    s->v[2] = (dot(a, s, 2) + 2 * dot(b, s, 1)) / 3;
    s->v[3] = dot(b, s, 2);
}

/* The error bounds of §4.3; false where the proof does not reach. */
static bool bounds(const struct motion *m, struct forms *s)
{
    double d[3];
    for (int k = 0; k < 3; k++) {
        d[k] = 0;
        for (int j = 0; j < 3; j++)
            d[k] = larger(
                d[k], larger(size(m->f[j].at[0][k]), size(m->f[j].at[1][k])));
        if (!(d[k] <= RANGE))
            return false;
    }
    for (int k = 0; k < 3; k++) {
        int i = k == 2 ? 0 : k + 1, j = 3 - k - i;
        s->eq[k] = ERROR_FORM * (d[i] * d[j]) + UNDERFLOW;
    }
    s->ev = ERROR_CUBIC * (d[0] * d[1] * d[2]) + UNDERFLOW;
    return true;
}

/* 1 or -1 where all n coefficients have that sign beyond error e, else 0. */
static int sign(const double *c, int n, double e)
{
    double lo = c[0], hi = c[0];
    for (int i = 1; i < n; i++) {
        lo = smaller(lo, c[i]);
        hi = larger(hi, c[i]);
    }
    return lo > e ? 1 : hi < -e ? -1 : 0;
}

/* The forms of §2; g × h stands in s->q[0]. */
static void make_forms(const struct motion *m, struct forms *s)
{
    for (int k = 0; k < 3; k++) {
        double n[3];
        if (m->count == 3) {
            cross(&m->f[2], &m->f[0], k, s->q[1][k]);
            cross(&m->f[0], &m->f[1], k, s->q[2][k]);
            continue;
        }
        memcpy(n, s->q[0][k], sizeof n);
        cross(&m->f[0], &m->f[2], k, s->q[0][k]);
        cross(&m->f[0], &m->f[1], k, s->q[2][k]);
        for (int i = 0; i < 3; i++) {
            s->q[1][k][i] = n[i] - s->q[0][k][i];
            s->q[3][k][i] = n[i] - s->q[2][k][i];
        }
    }
}

/* Two forms of strictly opposite sign on one axis: no contact (§3). */
static bool opposite(const struct forms *s, int count)
{
    for (int k = 0; k < 3; k++) {
        bool up = false, down = false;
        for (int j = 0; j < count; j++) {
            int g = sign(s->q[j][k], 3, s->eq[k]);
            up = up || g > 0;
            down = down || g < 0;
        }
        if (up && down)
            return true;
    }
    return false;
}

int filter_signs(const struct motion *m, struct forms *s, bool *inside)
{
    *inside = true;
    for (int k = 0; k < 3; k++) {
        double most;
        if (apart(m, k, &most))
            return FILTER_MISS;
        s->eb[k] = ERROR_BOX * most + UNDERFLOW;
    }
    if (!bounds(m, s)) {
        *inside = false;
        return FILTER_UNSURE;
    }
    for (int k = 0; k < 3; k++)
        cross(&m->f[1], &m->f[2], k, s->q[0][k]);
    cubic(&m->f[0], s);
    if (sign(s->v, 4, s->ev))
        return FILTER_MISS;
    make_forms(m, s);
    return opposite(s, m->count) ? FILTER_MISS : FILTER_UNSURE;
}

static double mix(double a, double b, double t)
{
    return (1 - t) * a + t * b;
}

/* Bernstein form on [a, b] of a quadratic, by blossoms (§5.1). */
static void restrict_form(const double c[3], double a, double b, double r[3])
{
    double p = mix(c[0], c[1], a), q = mix(c[1], c[2], a);
    double u = mix(c[0], c[1], b), v = mix(c[1], c[2], b);
    r[0] = mix(p, q, a);
    r[1] = mix(p, q, b);
    r[2] = mix(u, v, b);
}

static void restrict_cubic(const double c[4], double a, double b, double r[4])
{
    double p[3], q[3];
    for (int i = 0; i < 3; i++) {
        p[i] = mix(c[i], c[i + 1], a);
        q[i] = mix(c[i], c[i + 1], b);
    }
    restrict_form(p, a, b, r);
    r[3] = mix(mix(q[0], q[1], b), mix(q[1], q[2], b), b);
}

static double value(const double c[4], double t)
{
    double p = mix(c[0], c[1], t), q = mix(c[1], c[2], t);
    double r = mix(c[2], c[3], t);
    return mix(mix(p, q, t), mix(q, r, t), t);
}

/* Whether [a, b] is free of contact by the box forms. */
static bool box_apart(const struct motion *m, const struct forms *s, double a,
                      double b)
{
    for (int k = 0; k < 3; k++) {
        bool up = true, down = true;
        for (int j = 0; j < m->count; j++) {
            double c0 = m->box[j].at[0][k], c1 = m->box[j].at[1][k];
            double c[2] = {mix(c0, c1, a), mix(c0, c1, b)};
            int g = sign(c, 2, s->eb[k]);
            up = up && g > 0;
            down = down && g < 0;
        }
        if (up || down)
            return true;
    }
    return false;
}

/* The forms' verdict on [a, b]: no contact there (-1), every root of V there
 * is a contact (1), or not known (0). */
static int touching(const struct forms *s, int count, double a, double b)
{
    int sure = 0;
    for (int k = 0; k < 3; k++) {
        int up = 0, down = 0;
        for (int j = 0; j < count; j++) {
            double c[3];
            restrict_form(s->q[j][k], a, b, c);
            int g = sign(c, 3, s->eq[k]);
            up += g > 0;
            down += g < 0;
        }
        if (up && down)
            return -1;
        if (up == count || down == count)
            sure = 1;
    }
    return sure;
}

/* What [a, b] holds of V's roots: NONE, ONE (simple, V of opposite certain
 * sign at the ends) or UNKNOWN. */
static int roots(const struct forms *s, double a, double b)
{
    double c[4], e = s->ev;
    restrict_cubic(s->v, a, b, c);
    if (sign(c, 4, e))
        return NONE;
    if (c[0] > e && c[3] < -e)
        return c[1] > e || c[2] < -e ? ONE : UNKNOWN;
    if (c[0] < -e && c[3] > e)
        return c[1] < -e || c[2] > e ? ONE : UNKNOWN;
    return UNKNOWN;
}

/* The cell [g, g + 1]·2^-GRID within [lo, hi] that holds V's one root there;
 * false, with the root not before *g, where V's sign cannot be told. */
static bool locate(const struct forms *s, uint32_t lo, uint32_t hi, uint32_t *g)
{
    bool rising = value(s->v, lo * 0x1p-30) < 0;
    while (hi - lo > 1) {
        uint32_t mid = lo + (hi - lo) / 2;
        double v = value(s->v, mid * 0x1p-30);
        if (!(size(v) > s->ev))
            break;
        if ((v < 0) == rising)
            lo = mid;
        else
            hi = mid;
    }
    *g = lo;
    return hi - lo == 1;
}

int filter_split(const struct motion *m, const struct forms *s, uint32_t *toi)
{
    uint32_t i = 0;
    int d = 0;
    for (int visit = 0; visit < VISIT_LIMIT; visit++) {
        uint32_t lo = i << (GRID - d), hi = (i + 1) << (GRID - d), g;
        double a = lo * 0x1p-30, b = hi * 0x1p-30;
        *toi = lo;
        int r = roots(s, a, b), inside = 0;
        if (r != NONE && (box_apart(m, s, a, b) ||
                          (inside = touching(s, m->count, a, b)) < 0))
            r = NONE;
        if (r == ONE) {
            bool found = locate(s, lo, hi, &g);
            *toi = g;
            if (!found)
                return FILTER_UNSURE;
            if (!inside)
                inside = touching(s, m->count, g * 0x1p-30, (g + 1) * 0x1p-30);
            if (!inside)
                return FILTER_UNSURE;
            if (inside > 0)
                return FILTER_HIT;
            r = NONE;
        }
        if (r == UNKNOWN) {
            if (d == DEPTH_LIMIT)
                return FILTER_UNSURE;
            i *= 2;
            d++;
            continue;
        }
        for (i++; d > 0 && !(i & 1); d--)
            i >>= 1;
        if (d == 0)
            return FILTER_MISS;
    }
    return FILTER_UNSURE;
}
