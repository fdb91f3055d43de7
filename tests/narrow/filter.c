/* SPDX-License-Identifier: Apache-2.0 */
/* Measures the filters' rounding errors against long double, where long double
 * is longer than double. spec/narrow/narrow.md §4.3 */
#include "ref/narrow/split.h"

#include <float.h>

#include "tests/base/choices.h"

typedef long double wide;

/* Returns a vector at time t, from exact positions. */
static void wide_at(double x[2][4][3], int a, int b, double t, wide r[3])
{
    for (int k = 0; k < 3; k++) {
        wide p = (wide)x[0][a][k] - x[0][b][k], q = (wide)x[1][a][k];
        r[k] = (1 - (wide)t) * p + (wide)t * (q - x[1][b][k]);
    }
}

static wide wide_cross(const wide a[3], const wide b[3], int k)
{
    int i = (k + 1) % 3, j = (k + 2) % 3;
    return a[i] * b[j] - a[j] * b[i];
}

/* Returns the value of a Bernstein form as the filter computes it (§5.1). */
static double blossom(const double *c, int n, double t)
{
    double p[4];
    for (int i = 0; i <= n; i++)
        p[i] = c[i];
    for (; n > 0; n--)
        for (int i = 0; i < n; i++)
            p[i] = (1 - t) * p[i] + t * p[i + 1];
    return p[0];
}

static double ratio(double a, wide b, double e)
{
    wide d = a - b;
    return (double)((d < 0 ? -d : d) / e);
}

/* Returns the largest ratio of error to bound, over V and the forms at one
 * time. */
static double worst(double x[2][4][3], int kind, const struct forms *s,
                    double t)
{
    static const int ends[2][3][2] = {{{1, 0}, {2, 0}, {3, 0}},
                                      {{2, 0}, {1, 0}, {3, 2}}};
    wide f[3][3], v = 0, q[4];
    double most = 0;
    for (int j = 0; j < 3; j++)
        wide_at(x, ends[kind][j][0], ends[kind][j][1], t, f[j]);
    for (int k = 0; k < 3; k++) {
        wide n = wide_cross(f[1], f[2], k);
        v += f[0][k] * n;
        q[0] = kind ? wide_cross(f[0], f[2], k) : n;
        q[1] = kind ? n - q[0] : wide_cross(f[2], f[0], k);
        q[2] = wide_cross(f[0], f[1], k);
        q[3] = n - q[2];
        for (int j = 0; j < 3 + kind; j++) {
            double r = ratio(blossom(s->q[j][k], 2, t), q[j], s->eq[k]);
            most = r > most ? r : most;
        }
    }
    double r = ratio(blossom(s->v, 3, t), v, s->ev);
    return r > most ? r : most;
}

/* No error exceeds its bound, and some errors come near their bound, so the
 * measurement is of the right errors. */
const char *test_filter_errors(void)
{
    struct bytes b = {.seed = 4, .size = -1};
    double most = 0;
    int64_t n = 0;
    if (LDBL_MANT_DIG < 64)
        return skip("long double is no longer than double");
    for (int k = 0; k < 200000; k++) {
        double x[2][4][3];
        struct motion m;
        struct forms s;
        bool inside;
        for (int i = 0; i < 24; i++)
            x[i / 12][i / 3 % 4][i % 3] =
                (double)pick_uniform(&b, -1, 1) * (1 + 100 * (i % 3));
        if (k & 1)
            motion_ee(x, &m);
        else
            motion_vf(x, &m);
        if (filter_signs(&m, &s, &inside) == FILTER_MISS)
            continue;
        double r = worst(x, k & 1, &s, (double)pick(&b, 1025) / 1024);
        most = r > most ? r : most;
        n++;
    }
    choices_free(&b);
    EXPECT(most <= 1);
    EXPECT(most >= 0.02);
    ran(n);
    return NULL;
}
