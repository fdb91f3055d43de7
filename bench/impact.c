/* SPDX-License-Identifier: Apache-2.0 */
/* Compares times of impact by drape_ccd, by FCL's Newton and by conservative
 * bisection with exact rationals, and distances with long double.
 * spec/accuracy.md §8 */
#include <drape.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "bench/bench.h"
#include "bench/bisect.h"
#include "oracle/oracle.h"
#include "ref/narrow/closest.h"

static uint64_t state = 1;

/* Returns a pseudorandom number, uniform in [-1, 1). */
static double uniform(void)
{
    state = state * UINT64_C(6364136223846793005) + 1442695040888963407u;
    return (double)(state >> 11) * 0x1p-52 - 1;
}

enum { OURS, NEWTON, BISECTION, METHODS };
static const char *const method_name[] = {"drape_ccd", "FCL 0.7 Newton",
                                          "bisection to 1e-6"};

struct query {
    int kind;
    double x[2][4][3];
};

/* Draws a query: primitives of 1 cm about 1 m from the origin that move by 1
 * cm, with coordinates of binary32. grazing: the motion is almost in the plane
 * of the primitives. */
static void pick_query(struct query *q, bool grazing)
{
    double from[3] = {uniform(), uniform(), uniform()};
    q->kind = uniform() > 0;
    for (int k = 0; k < 4; k++)
        for (int i = 0; i < 3; i++) {
            double flat = grazing && i == 2 ? 1e-3 : 1;
            double x = from[i] + 0.005 * flat * uniform();
            q->x[0][k][i] = (float)x;
            q->x[1][k][i] = (float)(x + 0.01 * flat * uniform());
        }
}

static bool answer(int method, const struct query *q, double *t)
{
    const double(*x0)[3] = (const double(*)[3])q->x[0];
    const double(*x1)[3] = (const double(*)[3])q->x[1];
    if (method == OURS)
        return drape_ccd(q->kind, x0, x1, t) == 1;
    if (method == NEWTON)
        return orc_ccd_fcl(q->kind, 0, x0, x1, t) == 1;
    return bisect(q->kind, x0, x1, 1e-6, t);
}

/* The errors of a method over many queries. */
struct score {
    int64_t missed, invented, late, hits;
    double early, after, seconds; /* largest errors of the time of impact:
                                     before the truth, and after it */
};

static void judge(struct score *s, bool touch, double truth, bool hit, double t)
{
    s->missed += touch && !hit;
    s->invented += hit && !touch;
    if (!touch || !hit)
        return;
    s->hits++;
    s->late += t > truth + 0x1p-30;
    s->early = fmax(s->early, truth - t);
    s->after = fmax(s->after, t - truth);
}

static void family(struct bench *b, FILE *out, bool grazing)
{
    int n = b->quick ? 500 : 20000;
    struct query *q = bench_take((size_t)n, sizeof *q);
    struct score s[METHODS] = {{0}};
    int64_t touching = 0;
    for (int k = 0; k < n; k++)
        pick_query(&q[k], grazing);
    double *t = bench_take((size_t)n, sizeof *t);
    bool *hit = bench_take((size_t)n, sizeof *hit);
    uint32_t *truth = bench_take((size_t)n, sizeof *truth);
    for (int k = 0; k < n; k++)
        touching += orc_ccd_gmp(q[k].kind, (const double(*)[3])q[k].x[0],
                                (const double(*)[3])q[k].x[1], &truth[k]) == 1;
    for (int m = 0; m < METHODS; m++) {
        double start = bench_clock();
        for (int k = 0; k < n; k++)
            hit[k] = answer(m, &q[k], &t[k]);
        s[m].seconds = bench_clock() - start;
        for (int k = 0; k < n; k++)
            judge(&s[m], truth[k] != ORC_NEVER, 0x1p-30 * truth[k], hit[k],
                  t[k]);
        fprintf(out, "%s,%s,%d,%lld,%lld,%lld,%lld,%.3g,%.3g,%.4g\n",
                grazing ? "grazing" : "plain", method_name[m], n,
                (long long)touching, (long long)s[m].missed,
                (long long)s[m].invented, (long long)s[m].late, s[m].early,
                s[m].after, 1e9 * s[m].seconds / n);
    }
    bench_check(b, !s[OURS].missed && !s[OURS].invented && !s[OURS].late,
                "drape_ccd: %lld missed, %lld invented, %lld late",
                (long long)s[OURS].missed, (long long)s[OURS].invented,
                (long long)s[OURS].late);
    bench_check(b, !s[BISECTION].missed, "bisection: %lld missed",
                (long long)s[BISECTION].missed);
    free(q);
    free(t);
    free(hit);
    free(truth);
}

void impact_times(struct bench *b)
{
    FILE *out = bench_csv(b, "impacts",
                          "family,method,queries,touch,missed,invented,late,"
                          "earliest by,latest by,ns a query");
    for (int grazing = 0; grazing < 2 && orc_present(); grazing++)
        family(b, out, grazing);
    fclose(out);
}

typedef long double wider[3];

static long double dot3(const wider a, const wider b)
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static long double to_segment(const wider p, const wider a, const wider b)
{
    wider d, e;
    for (int i = 0; i < 3; i++) {
        d[i] = b[i] - a[i];
        e[i] = p[i] - a[i];
    }
    long double dd = dot3(d, d), t = dd > 0 ? dot3(e, d) / dd : 0;
    t = t < 0 ? 0 : t > 1 ? 1 : t;
    for (int i = 0; i < 3; i++)
        e[i] -= t * d[i];
    return sqrtl(dot3(e, e));
}

/* Returns the distance of point x[0] from triangle x[1..3]: the least over the
 * edges and, if the foot of the perpendicular is inside, the plane. */
static long double truth(const vec x[4])
{
    wider p[4], u, v, w, n, c;
    for (int k = 0; k < 4; k++) {
        p[k][0] = x[k].x;
        p[k][1] = x[k].y;
        p[k][2] = x[k].z;
    }
    long double d = fminl(
        to_segment(p[0], p[1], p[2]),
        fminl(to_segment(p[0], p[2], p[3]), to_segment(p[0], p[3], p[1])));
    for (int i = 0; i < 3; i++) {
        u[i] = p[2][i] - p[1][i];
        v[i] = p[3][i] - p[1][i];
        w[i] = p[0][i] - p[1][i];
    }
    for (int i = 0; i < 3; i++)
        n[i] =
            u[(i + 1) % 3] * v[(i + 2) % 3] - u[(i + 2) % 3] * v[(i + 1) % 3];
    long double nn = dot3(n, n);
    if (nn == 0)
        return d;
    for (int i = 0; i < 3; i++)
        c[i] =
            w[(i + 1) % 3] * v[(i + 2) % 3] - w[(i + 2) % 3] * v[(i + 1) % 3];
    long double s = dot3(c, n) / nn;
    for (int i = 0; i < 3; i++)
        c[i] =
            u[(i + 1) % 3] * w[(i + 2) % 3] - u[(i + 2) % 3] * w[(i + 1) % 3];
    long double t = dot3(c, n) / nn;
    return s >= 0 && t >= 0 && s + t <= 1 ? fabsl(dot3(w, n)) / sqrtl(nn) : d;
}

/* Returns the distance by the textbook in binary32: the foot in barycentric
 * coordinates by Cramer's rule. It is correct only if the foot is inside, as
 * here. */
static float textbook(const vec x[4])
{
    vec u = vec_sub(x[2], x[1]), v = vec_sub(x[3], x[1]);
    vec w = vec_sub(x[0], x[1]);
    float uu = vec_dot(u, u), uv = vec_dot(u, v), vv = vec_dot(v, v);
    float uw = vec_dot(u, w), vw = vec_dot(v, w), det = uu * vv - uv * uv;
    float s = (vv * uw - uv * vw) / det, t = (uu * vw - uv * uw) / det;
    vec d = vec_sub(w, vec_add(vec_scale(s, u), vec_scale(t, v)));
    return sqrtf(vec_dot(d, d));
}

/* Draws an orthonormal frame of no special direction. */
static void pick_frame(double f[3][3])
{
    for (int k = 0; k < 2; k++) {
        double along = 0, length = 0;
        for (int i = 0; i < 3; i++) {
            f[k][i] = uniform();
            along += k ? f[0][i] * f[1][i] : 0;
        }
        for (int i = 0; i < 3; i++) {
            f[k][i] -= k ? along * f[0][i] : 0;
            length += f[k][i] * f[k][i];
        }
        for (int i = 0; i < 3; i++)
            f[k][i] /= sqrt(length);
    }
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        f[2][i] = f[0][j] * f[1][k] - f[0][k] * f[1][j];
    }
}

/* Draws a triangle of 1 cm × 1 cm · thin, 1 m from the origin, and a point 1 mm
 * above the inside of the triangle. */
static void pick_point(double thin, vec x[4])
{
    double f[3][3], c = 0.3 + 0.2 * uniform();
    double a = 0.3 + 0.2 * uniform() + c / 2;
    double at[4][3] = {
        {a, c * thin, 0.1}, {0, 0, 0}, {1, 0, 0}, {0.5, thin, 0}};
    pick_frame(f);
    for (int k = 0; k < 4; k++) {
        double y[3];
        for (int i = 0; i < 3; i++)
            y[i] = f[1][i] + 0.01 * (at[k][0] * f[0][i] + at[k][1] * f[1][i] +
                                     at[k][2] * f[2][i]);
        x[k] = vec_make((real)y[0], (real)y[1], (real)y[2]);
    }
}

/* Computes the relative errors of a distance: drape's and the textbook's. */
static void compare(double thin, double e[2])
{
    vec x[4];
    struct wide y[4];
    struct closest r;
    pick_point(thin, x);
    for (int i = 0; i < 4; i++)
        y[i] = wide_of(x[i]);
    closest_vf(y, &r);
    long double d = truth(x);
    e[0] = (double)(fabsl((long double)sqrt(r.length2) - d) / d);
    e[1] = (double)(fabsl((long double)textbook(x) - d) / d);
    e[1] = e[1] >= 0 ? e[1] : 1e30; /* in place of NaN */
}

void impact_distances(struct bench *b)
{
    FILE *out = bench_csv(b, "distances",
                          "height by width,ours: typical,ours: largest,"
                          "textbook: typical,textbook: largest");
    int cases = b->quick ? 200 : 5000;
    for (int k = 0; k <= 6; k++) {
        double e[2], largest[2] = {0, 0}, sum[2] = {0, 0};
        for (int n = 0; n < cases; n++) {
            compare(pow(10, -k), e);
            for (int i = 0; i < 2; i++) {
                largest[i] = fmax(largest[i], e[i]);
                sum[i] += log10(e[i] + 1e-18) / cases;
            }
        }
        fprintf(out, "%g,%.2e,%.2e,%.2e,%.2e\n", pow(10, -k), pow(10, sum[0]),
                largest[0], pow(10, sum[1]), largest[1]);
        bench_check(b, largest[0] < 1e-6, "distance at 1e-%d: off by %g", k,
                    largest[0]);
    }
    fclose(out);
}
