/* SPDX-License-Identifier: Apache-2.0 */
/* Tier 2 of the narrow phase: subdivides [0, 1] in binary64, with proven error
 * bounds. spec/narrow/narrow.md §5 */
#include "ref/narrow/split.h"

#define GRID 30        /* contact times are multiples of 2^-GRID */
#define DEPTH_LIMIT 20 /* most levels of subdivision */
#define VISIT_LIMIT 64 /* most intervals that are tested */

/* The roots of V in an interval: none, exactly one, or unknown. */
enum { NONE, ONE, UNKNOWN };

static double interpolate(double a, double b, double t)
{
    return (1 - t) * a + t * b;
}

/* Writes the Bernstein form on [a, b] of a quadratic, by blossoms (§5.1). */
static void restrict_form(const double c[3], double a, double b, double r[3])
{
    double p = interpolate(c[0], c[1], a), q = interpolate(c[1], c[2], a);
    double u = interpolate(c[0], c[1], b), v = interpolate(c[1], c[2], b);
    r[0] = interpolate(p, q, a);
    r[1] = interpolate(p, q, b);
    r[2] = interpolate(u, v, b);
}

static void restrict_cubic(const double c[4], double a, double b, double r[4])
{
    double p[3], q[3];
    for (int i = 0; i < 3; i++) {
        p[i] = interpolate(c[i], c[i + 1], a);
        q[i] = interpolate(c[i], c[i + 1], b);
    }
    restrict_form(p, a, b, r);
    r[3] =
        interpolate(interpolate(q[0], q[1], b), interpolate(q[1], q[2], b), b);
}

static double evaluate_cubic(const double c[4], double t)
{
    double p = interpolate(c[0], c[1], t), q = interpolate(c[1], c[2], t);
    double r = interpolate(c[2], c[3], t);
    return interpolate(interpolate(p, q, t), interpolate(q, r, t), t);
}

/* Whether the box forms prove that [a, b] has no contact. */
static bool box_apart(const struct motion *m, const struct forms *s, double a,
                      double b)
{
    for (int k = 0; k < 3; k++) {
        bool up = true, down = true;
        for (int j = 0; j < m->count; j++) {
            double c0 = m->box[j].at[0][k], c1 = m->box[j].at[1][k];
            double c[2] = {interpolate(c0, c1, a), interpolate(c0, c1, b)};
            int g = filter_sign(c, 2, s->eb[k]);
            up = up && g > 0;
            down = down && g < 0;
        }
        if (up || down)
            return true;
    }
    return false;
}

/* Tests the forms on [a, b]. Returns -1 where there is no contact in [a, b],
 * 1 where every root of V in [a, b] is a contact, and 0 where neither is
 * certain. */
static int test_forms(const struct forms *s, int count, double a, double b)
{
    int sure = 0;
    for (int k = 0; k < 3; k++) {
        int up = 0, down = 0;
        for (int j = 0; j < count; j++) {
            double c[3];
            restrict_form(s->q[j][k], a, b, c);
            int g = filter_sign(c, 3, s->eq[k]);
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

/* Counts the roots of V in [a, b]. ONE means a simple root, with certain and
 * opposite signs of V at the ends. */
static int count_roots(const struct forms *s, double a, double b)
{
    double c[4], e = s->ev;
    restrict_cubic(s->v, a, b, c);
    if (filter_sign(c, 4, e))
        return NONE;
    if (c[0] > e && c[3] < -e)
        return c[1] > e || c[2] < -e ? ONE : UNKNOWN;
    if (c[0] < -e && c[3] > e)
        return c[1] < -e || c[2] > e ? ONE : UNKNOWN;
    return UNKNOWN;
}

/* Bisects [lo, hi], which holds one root of V, to the cell [g, g + 1]·2^-GRID
 * with the root. Returns false where a sign of V is uncertain; the root is then
 * not before *g. */
static bool locate_root(const struct forms *s, uint32_t lo, uint32_t hi,
                        uint32_t *g)
{
    bool rising = evaluate_cubic(s->v, lo * 0x1p-30) < 0;
    while (hi - lo > 1) {
        uint32_t mid = lo + (hi - lo) / 2;
        double v = evaluate_cubic(s->v, mid * 0x1p-30);
        if (!(v > s->ev || v < -s->ev))
            break;
        if ((v < 0) == rising)
            lo = mid;
        else
            hi = mid;
    }
    *g = lo;
    return hi - lo == 1;
}

int split_interval(const struct motion *m, const struct forms *s, uint32_t *toi)
{
    uint32_t i = 0;
    int d = 0;
    for (int visit = 0; visit < VISIT_LIMIT; visit++) {
        uint32_t lo = i << (GRID - d), hi = (i + 1) << (GRID - d), g;
        double a = lo * 0x1p-30, b = hi * 0x1p-30;
        *toi = lo;
        int r = count_roots(s, a, b), inside = 0;
        if (r != NONE && (box_apart(m, s, a, b) ||
                          (inside = test_forms(s, m->count, a, b)) < 0))
            r = NONE;
        if (r == ONE) {
            bool found = locate_root(s, lo, hi, &g);
            *toi = g;
            if (!found)
                return FILTER_UNSURE;
            if (!inside)
                inside =
                    test_forms(s, m->count, g * 0x1p-30, (g + 1) * 0x1p-30);
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
