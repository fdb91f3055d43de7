/* SPDX-License-Identifier: Apache-2.0 */
/* Closest points of two primitives on the device, and the weights and normal of
 * a contact. spec/contact/proximity.md §1 and §2 */
#ifndef GPU_CLOSEST_CUH
#define GPU_CLOSEST_CUH

#include "gpu/base/wide.cuh"

extern "C" {
#include "ref/narrow/closest.h"
}

/* A search: four points relative to the first, and the nearest candidate so
 * far.
 */
struct closest_pair {
    struct wide y[4];
    struct closest best; /* length2 < 0: no candidate yet */
};

static __device__ inline void closest_from(const struct wide x[4],
                                           struct closest_pair *p)
{
    p->best.length2 = -1;
    p->best.size2 = 0;
    for (int k = 0; k < 4; k++) {
        p->y[k] = sub(x[k], x[0]);
        p->best.size2 = max_of(dot(p->y[k], p->y[k]), p->best.size2);
    }
}

/* Keeps the candidate with these weights if its points are nearer than all
 * before; of a tie the first candidate stays. */
static __device__ inline void closest_offer(struct closest_pair *p, double c0,
                                            double c1, double c2, double c3)
{
    struct wide d = scale(c1, p->y[1]);
    d = axpy(d, c2, p->y[2]);
    d = axpy(d, c3, p->y[3]);
    double l = dot(d, d);
    if (p->best.length2 >= 0 && !(l < p->best.length2))
        return;
    p->best.c[0] = c0;
    p->best.c[1] = c1;
    p->best.c[2] = c2;
    p->best.c[3] = c3;
    p->best.p = d;
    p->best.length2 = l;
}

/* a / b within [0, 1]; 0 where either is not above 0. */
static __device__ inline double closest_ratio(double a, double b)
{
    if (!(a > 0 && b > 0))
        return 0;
    return a < b ? a / b : 1;
}

/* The parameter in [0, 1] of the point on edge a b that is nearest to y[0], the
 * origin. */
static __device__ inline double closest_along(struct wide a, struct wide b)
{
    struct wide d = sub(b, a);
    return closest_ratio(-dot(a, d), dot(d, d));
}

/* §1.1: closest points of vertex x[0] and the closed triangle x[1] x[2] x[3].
 */
static __device__ inline struct closest nearest_vf(const struct wide x[4])
{
    struct closest_pair p;
    closest_from(x, &p);
    struct wide e = sub(p.y[2], p.y[1]), f = sub(p.y[3], p.y[1]);
    struct wide q = scale(-1, p.y[1]), n = cross(e, f);
    double nn = dot(n, n);
    if (nn > 0) {
        double s = dot(cross(q, f), n) / nn;
        double t = dot(cross(e, q), n) / nn;
        if (s >= 0 && t >= 0 && s + t <= 1)
            closest_offer(&p, 1, -((1 - s) - t), -s, -t);
    }
    double t = closest_along(p.y[1], p.y[2]);
    closest_offer(&p, 1, -(1 - t), -t, 0);
    t = closest_along(p.y[2], p.y[3]);
    closest_offer(&p, 1, 0, -(1 - t), -t);
    t = closest_along(p.y[3], p.y[1]);
    closest_offer(&p, 1, -t, 0, -(1 - t));
    return p.best;
}

/* §1.2: closest points of the closed segments x[0] x[1] and x[2] x[3]. */
static __device__ inline struct closest nearest_ee(const struct wide x[4])
{
    struct closest_pair p;
    closest_from(x, &p);
    struct wide d = p.y[1], e = sub(p.y[3], p.y[2]);
    double dd = dot(d, d), ee = dot(e, e), de = dot(d, e);
    double dq = -dot(d, p.y[2]), eq = -dot(e, p.y[2]);
    double det = dd * ee - de * de;
    if (det > 0) {
        double first = closest_ratio(de * eq - dq * ee, det);
        double t = closest_ratio(eq + first * de, ee);
        double s = closest_ratio(t * de - dq, dd);
        closest_offer(&p, 1 - s, s, -(1 - t), -t);
    }
    double t = closest_ratio(eq, ee);
    closest_offer(&p, 1, 0, -(1 - t), -t);
    t = closest_ratio(eq + de, ee);
    closest_offer(&p, 0, 1, -(1 - t), -t);
    double s = closest_ratio(-dq, dd);
    closest_offer(&p, 1 - s, s, -1, 0);
    s = closest_ratio(de - dq, dd);
    closest_offer(&p, 1 - s, s, 0, -1);
    return p.best;
}

/* kind: enum contact_kind. */
static __device__ inline struct closest nearest(const struct wide x[4],
                                                int kind)
{
    return kind == 0 ? nearest_vf(x) : nearest_ee(x);
}

/* The nearest multiple of 2^-22, or 2^-50 in binary64. */
static __device__ inline double closest_quantum(double a)
{
    const double shift = REAL_BITS == 32 ? 0x1.8p30 : 0x1.8p2;
    return (a + shift) - shift;
}

/* §2.3: the weights c of a contact: rounded, adding to 0 exactly. */
static __device__ inline void nearest_weights(const struct closest *r, int kind,
                                              real c[4])
{
    double t = closest_quantum(-r->c[3]);
    if (kind == 0) {
        double s = closest_quantum(-r->c[2]);
        t = min_of(t, 1 - s);
        c[0] = 1;
        c[1] = -(real)((1 - s) - t);
        c[2] = -(real)s;
    } else {
        double s = closest_quantum(r->c[1]);
        c[0] = (real)(1 - s);
        c[1] = (real)s;
        c[2] = -(real)(1 - t);
    }
    c[3] = -(real)t;
}

/* The triangle's normal, or the cross product of the edges, not normalised. */
static __device__ inline struct wide nearest_normal(const struct wide x[4],
                                                    int kind)
{
    struct wide a = kind == 0 ? sub(x[2], x[1]) : sub(x[1], x[0]);
    struct wide b = kind == 0 ? sub(x[3], x[1]) : sub(x[3], x[2]);
    return cross(a, b);
}

/* §2.4: a times a power of two: no product of four such lengths underflows. */
static __device__ inline struct wide lift(struct wide a)
{
    for (int k = 0; k < 3 && dot(a, a) < 0x1p-400; k++)
        a = scale(0x1p300, a);
    return a;
}

/* a divided by its length, or the fallback where the length is zero or not
 * finite. */
static __device__ inline struct wide unit(struct wide a, struct wide fallback)
{
    a = lift(a);
    double l = sqrt(dot(a, a));
    if (!(l > 0 && l - l == 0))
        return fallback;
    return wide3(a.x / l, a.y / l, a.z / l);
}

#endif
