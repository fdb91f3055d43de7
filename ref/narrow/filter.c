/* SPDX-License-Identifier: Apache-2.0 */
/* Tier 1 of the narrow phase: a floating-point filter with proven error bounds,
 * which rejects most pairs. spec/narrow/narrow.md §4 */
#include "ref/narrow/filter.h"

#include "ref/base/real.h"

/* Error bounds of §4.3, proven in spec/proofs/narrow_*.gappa. δ is the largest
 * component on an axis. */
#define ERROR_FORM 0x1p-47  /* times δiδj */
#define ERROR_CUBIC 0x1p-45 /* times δxδyδz */
#define ERROR_BOX 0x1p-51   /* times the largest box form */
#define UNDERFLOW 0x1p-800  /* bounds the loss by underflow */
#define RANGE 0x1p200       /* largest δ that the proof covers */

static void subtract_points(const double a[3], const double b[3], double c[3])
{
    for (int k = 0; k < 3; k++)
        c[k] = a[k] - b[k];
}

void motion_vf(double x[2][4][3], struct motion *m)
{
    m->count = 3;
    for (int j = 0; j < 3; j++)
        for (int t = 0; t < 2; t++) {
            subtract_points(x[t][j + 1], x[t][0], m->f[j].at[t]);
            memcpy(m->box[j].at[t], m->f[j].at[t], sizeof m->f[j].at[t]);
        }
}

void motion_ee(double x[2][4][3], struct motion *m)
{
    m->count = 4;
    for (int t = 0; t < 2; t++) {
        subtract_points(x[t][2], x[t][0], m->f[0].at[t]);
        subtract_points(x[t][1], x[t][0], m->f[1].at[t]);
        subtract_points(x[t][3], x[t][2], m->f[2].at[t]);
        subtract_points(x[t][2], x[t][0], m->box[0].at[t]);
        subtract_points(x[t][3], x[t][0], m->box[1].at[t]);
        subtract_points(x[t][2], x[t][1], m->box[2].at[t]);
        subtract_points(x[t][3], x[t][1], m->box[3].at[t]);
    }
}

/* Whether on axis k all box forms keep one strict sign (§4.1), so that the pair
 * misses. No error bound is needed: a rounded difference has the exact sign.
 * *most is the largest magnitude. */
static bool is_apart(const struct motion *m, int k, double *most)
{
    double lo = m->box[0].at[0][k], hi = lo;
    for (int j = 0; j < m->count; j++)
        for (int t = 0; t < 2; t++) {
            lo = smaller_of(lo, m->box[j].at[t][k]);
            hi = larger_of(hi, m->box[j].at[t][k]);
        }
    *most = larger_of(-lo, hi);
    return lo > 0 || hi < 0;
}

/* Writes component k of f × g in Bernstein form. */
static void cross_forms(const struct linear *f, const struct linear *g, int k,
                        double c[3])
{
    const double *a0 = f->at[0], *a1 = f->at[1], *b0 = g->at[0], *b1 = g->at[1];
    int i = k == 2 ? 0 : k + 1, j = 3 - k - i;
    c[0] = a0[i] * b0[j] - a0[j] * b0[i];
    c[1] = ((a0[i] * b1[j] - a0[j] * b1[i]) + (a1[i] * b0[j] - a1[j] * b0[i])) *
           0.5;
    c[2] = a1[i] * b1[j] - a1[j] * b1[i];
}

static double dot_form(const double a[3], const struct forms *s, int i)
{
    return a[0] * s->q[0][0][i] + a[1] * s->q[0][1][i] + a[2] * s->q[0][2][i];
}

/* Writes V = f · (g × h). The cross product must be in s->q[0]. */
static void write_cubic(const struct linear *f, struct forms *s)
{
    const double *a = f->at[0], *b = f->at[1];
    s->v[0] = dot_form(a, s, 0);
    s->v[1] = (dot_form(b, s, 0) + 2 * dot_form(a, s, 1)) / 3;
    s->v[2] = (dot_form(a, s, 2) + 2 * dot_form(b, s, 1)) / 3;
    s->v[3] = dot_form(b, s, 2);
}

/* Sets the error bounds of §4.3. Returns false where the inputs are beyond the
 * range of the proof. */
static bool set_error_bounds(const struct motion *m, struct forms *s)
{
    double d[3];
    for (int k = 0; k < 3; k++) {
        d[k] = 0;
        for (int j = 0; j < 6; j++) {
            double a = m->f[j / 2].at[j % 2][k];
            d[k] = larger_of(d[k], larger_of(a, -a));
        }
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

/* Writes the forms of §2. g × h must be in s->q[0]. */
static void make_forms(const struct motion *m, struct forms *s)
{
    for (int k = 0; k < 3; k++) {
        double n[3];
        if (m->count == 3) {
            cross_forms(&m->f[2], &m->f[0], k, s->q[1][k]);
            cross_forms(&m->f[0], &m->f[1], k, s->q[2][k]);
            continue;
        }
        memcpy(n, s->q[0][k], sizeof n);
        cross_forms(&m->f[0], &m->f[2], k, s->q[0][k]);
        cross_forms(&m->f[0], &m->f[1], k, s->q[2][k]);
        for (int i = 0; i < 3; i++) {
            s->q[1][k][i] = n[i] - s->q[0][k][i];
            s->q[3][k][i] = n[i] - s->q[2][k][i];
        }
    }
}

/* Whether two forms have strictly opposite signs on one axis, beyond their
 * errors: then there is no contact (§3b). */
static bool has_opposite_forms(const struct forms *s, int count)
{
    for (int k = 0; k < 3; k++) {
        bool up = false, down = false;
        for (int j = 0; j < count; j++) {
            int g = filter_sign(s->q[j][k], 3, s->eq[k]);
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
        if (is_apart(m, k, &most))
            return FILTER_MISS;
        s->eb[k] = ERROR_BOX * most + UNDERFLOW;
    }
    if (!set_error_bounds(m, s)) {
        *inside = false;
        return FILTER_UNSURE;
    }
    for (int k = 0; k < 3; k++)
        cross_forms(&m->f[1], &m->f[2], k, s->q[0][k]);
    write_cubic(&m->f[0], s);
    if (filter_sign(s->v, 4, s->ev))
        return FILTER_MISS;
    make_forms(m, s);
    return has_opposite_forms(s, m->count) ? FILTER_MISS : FILTER_UNSURE;
}
