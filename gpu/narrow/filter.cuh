/* SPDX-License-Identifier: Apache-2.0 */
/* Tier 1 of the narrow phase on the device, and the polynomials of tier 2. Both
 * kinds of pair take one path: a vertex-face pair gets a fourth form and box
 * form equal to its third. spec/narrow/narrow.md §2, §4 */
#ifndef GPU_FILTER_CUH
#define GPU_FILTER_CUH

#include "gpu/base/real.cuh"

/* Error bounds of §4.3, equal to ref/narrow/filter.c; ci/prove.sh checks
 * both. */
#define ERROR_FORM 0x1p-47
#define ERROR_CUBIC 0x1p-45
#define ERROR_BOX 0x1p-51
#define UNDERFLOW 0x1p-800
#define RANGE 0x1p200

/* The vertices of a pair at t = 0 and t = 1. */
struct quad {
    vec x[2][4];
    bool ee; /* edge-edge */
};

/* The vectors f, g, h of §2 at t = 0 and t = 1. */
struct vectors {
    double f[2][3], g[2][3], h[2][3];
};

/* §4.3: error bounds of V, and of the forms by axis. */
struct errors {
    double v, q[3];
};

/* §4.1, evaluated on the positions themselves: a rounded difference has the
 * same sign as the comparison. */

static __device__ inline bool box_apart(real a0, real a1, real b0, real b1,
                                        real b2, real c0, real c1, real d0,
                                        real d1, real d2)
{
    real low_b = min_of(b0, min_of(b1, b2)),
         high_b = max_of(b0, max_of(b1, b2));
    real low_d = min_of(d0, min_of(d1, d2)),
         high_d = max_of(d0, max_of(d1, d2));
    return (low_b > max_of(a0, a1) && low_d > max_of(c0, c1)) ||
           (high_b < min_of(a0, a1) && high_d < min_of(c0, c1));
}

/* Whether on some axis one primitive stays strictly beyond the other. Side A of
 * a vertex-face pair is the vertex taken twice; side B of an edge-edge pair has
 * one end of the edge twice. */
static __device__ inline bool boxes_apart(const struct quad *p)
{
    const vec *s = p->x[0], *e = p->x[1];
    vec a = p->ee ? s[1] : s[0], b = p->ee ? s[2] : s[1];
    vec c = p->ee ? e[1] : e[0], d = p->ee ? e[2] : e[1];
    return box_apart(s[0].x, a.x, b.x, s[2].x, s[3].x, e[0].x, c.x, d.x, e[2].x,
                     e[3].x) ||
           box_apart(s[0].y, a.y, b.y, s[2].y, s[3].y, e[0].y, c.y, d.y, e[2].y,
                     e[3].y) ||
           box_apart(s[0].z, a.z, b.z, s[2].z, s[3].z, e[0].z, c.z, d.z, e[2].z,
                     e[3].z);
}

/* Writes a - b, rounded once; widening to binary64 is exact. */
static __device__ inline void difference(vec a, vec b, double d[3])
{
    d[0] = (double)a.x - (double)b.x;
    d[1] = (double)a.y - (double)b.y;
    d[2] = (double)a.z - (double)b.z;
}

static __device__ inline struct vectors vectors_of(const struct quad *p)
{
    struct vectors m;
    for (int t = 0; t < 2; t++) {
        const vec *x = p->x[t];
        difference(p->ee ? x[2] : x[1], x[0], m.f[t]);
        difference(p->ee ? x[1] : x[2], x[0], m.g[t]);
        difference(x[3], p->ee ? x[2] : x[0], m.h[t]);
    }
    return m;
}

/* Writes component k of a × b in Bernstein form. */
static __device__ inline void
cross_form(const double a[2][3], const double b[2][3], int k, double c[3])
{
    int i = k == 2 ? 0 : k + 1, j = 3 - k - i;
    c[0] = a[0][i] * b[0][j] - a[0][j] * b[0][i];
    double first = a[0][i] * b[1][j] - a[0][j] * b[1][i];
    double second = a[1][i] * b[0][j] - a[1][j] * b[0][i];
    c[1] = (first + second) * 0.5;
    c[2] = a[1][i] * b[1][j] - a[1][j] * b[1][i];
}

/* Returns f · (coefficient i of n). */
static __device__ inline double dot_form(const double f[3],
                                         const double n[3][3], int i)
{
    return (f[0] * n[0][i] + f[1] * n[1][i]) + f[2] * n[2][i];
}

/* Writes V in Bernstein form; n is g × h. */
static __device__ inline void cubic_form(const double f[2][3],
                                         const double n[3][3], double v[4])
{
    v[0] = dot_form(f[0], n, 0);
    v[1] = (dot_form(f[1], n, 0) + 2 * dot_form(f[0], n, 1)) / 3;
    v[2] = (dot_form(f[0], n, 2) + 2 * dot_form(f[1], n, 1)) / 3;
    v[3] = dot_form(f[1], n, 2);
}

/* Writes the forms on axis k; n is component k of g × h. For vertex-face they
 * are n, h×f = -(f×h), which differs only in the sign of a zero, and f×g. */
static __device__ inline void axis_forms(const struct vectors *m, bool ee,
                                         int k, const double n[3],
                                         double w[4][3])
{
    double q[3], r[3];
    cross_form(m->f, m->h, k, q);
    cross_form(m->f, m->g, k, r);
    for (int i = 0; i < 3; i++) {
        w[0][i] = ee ? q[i] : n[i];
        w[1][i] = ee ? n[i] - q[i] : -q[i];
        w[2][i] = r[i];
        w[3][i] = ee ? n[i] - r[i] : r[i];
    }
}

static __device__ inline double size_on(const struct vectors *m, int k)
{
    double d = 0;
    for (int t = 0; t < 2; t++)
        d = max_of(d, max_of(fabs(m->f[t][k]),
                             max_of(fabs(m->g[t][k]), fabs(m->h[t][k]))));
    return d;
}

/* Sets the error bounds of §4.3. Returns false where the inputs are beyond the
 * range of the proof. */
static __device__ inline bool errors_of(const struct vectors *m,
                                        struct errors *e)
{
    double x = size_on(m, 0), y = size_on(m, 1), z = size_on(m, 2);
    e->q[0] = ERROR_FORM * (y * z) + UNDERFLOW;
    e->q[1] = ERROR_FORM * (z * x) + UNDERFLOW;
    e->q[2] = ERROR_FORM * (x * y) + UNDERFLOW;
    e->v = ERROR_CUBIC * (x * y * z) + UNDERFLOW;
    return x <= RANGE && y <= RANGE && z <= RANGE;
}

/* Returns 1 or -1 where all coefficients have that sign by more than the error
 * bound e, else 0. */
static __device__ inline int certain(const double c[3], double e)
{
    if (min_of(c[0], min_of(c[1], c[2])) > e)
        return 1;
    return max_of(c[0], max_of(c[1], c[2])) < -e ? -1 : 0;
}

static __device__ inline int certain_cubic(const double c[4], double e)
{
    if (min_of(min_of(c[0], c[1]), min_of(c[2], c[3])) > e)
        return 1;
    return max_of(max_of(c[0], c[1]), max_of(c[2], c[3])) < -e ? -1 : 0;
}

/* §4.2: whether two forms on axis k have certain and opposite signs. */
static __device__ inline bool opposed(const struct vectors *m, bool ee, int k,
                                      const double n[3], double e)
{
    double w[4][3];
    bool up = false, down = false;
    axis_forms(m, ee, k, n, w);
    for (int j = 0; j < 4; j++) {
        int sign = certain(w[j], e);
        up = up || sign > 0;
        down = down || sign < 0;
    }
    return up && down;
}

/* §4: true where the pair certainly misses. */
static __device__ inline bool filter_misses(const struct quad *p)
{
    if (boxes_apart(p))
        return true;
    struct vectors m = vectors_of(p);
    struct errors e;
    if (!errors_of(&m, &e))
        return false;
    double n[3][3], v[4];
    for (int k = 0; k < 3; k++)
        cross_form(m.g, m.h, k, n[k]);
    cubic_form(m.f, n, v);
    return certain_cubic(v, e.v) || opposed(&m, p->ee, 0, n[0], e.q[0]) ||
           opposed(&m, p->ee, 1, n[1], e.q[1]) ||
           opposed(&m, p->ee, 2, n[2], e.q[2]);
}

#endif
