/* SPDX-License-Identifier: Apache-2.0 */
/* Floating-point filters for two triangles on the device: their answers are
 * certain although their numbers are rounded. spec/narrow/audit.md §3.5 */
#ifndef GPU_FACING_CUH
#define GPU_FACING_CUH

#include "gpu/base/real.cuh"

extern "C" {
#include "ref/narrow/tritri.h"
}

/* Error bounds of §3.5, equal to ref/narrow/tritri.c; ci/prove.sh checks
 * both. */
#define ERROR_BESIDE 0x1p-49
#define ERROR_PARTED 0x1p-49
#define ERROR_OPENED 0x1p-48
#define UNDERFLOW 0x1p-1000
#define UNDERFLOW_OPENED 0x1p-700

/* Two triangles; the vertices that they share come first in both, in the same
 * order. */
struct facing {
    point t[3], s[3];
    int shared;
};

static __device__ inline void from(const point o, const point p, point r)
{
    for (int k = 0; k < 3; k++)
        r[k] = p[k] - o[k];
}

static __device__ inline double dot(const point a, const point b)
{
    return (a[0] * b[0] + a[1] * b[1]) + a[2] * b[2];
}

static __device__ inline double dot_size(const point a, const point b)
{
    return (fabs(a[0] * b[0]) + fabs(a[1] * b[1])) + fabs(a[2] * b[2]);
}

static __device__ inline struct plane plane_of(const struct face *t)
{
    struct plane r;
    point a, b;
    from(t->p[0], t->p[1], a);
    from(t->p[0], t->p[2], b);
    for (int k = 0; k < 3; k++) {
        int i = (k + 1) % 3, j = (k + 2) % 3;
        double p = a[i] * b[j], q = a[j] * b[i];
        r.o[k] = t->p[0][k];
        r.n[k] = p - q;
        r.size[k] = fabs(p) + fabs(q);
    }
    return r;
}

/* Whether the corners of s in `mask` certainly lie strictly on one side of the
 * plane. */
static __device__ inline bool beside(const struct plane *t,
                                     const struct face *s, unsigned mask)
{
    point d;
    unsigned above = 0, below = 0;
    for (int k = 0; k < 3; k++) {
        from(t->o, s->p[k], d);
        double h = dot(t->n, d);
        double error = ERROR_BESIDE * dot_size(t->size, d) + UNDERFLOW;
        above |= (unsigned)(h > error) << k;
        below |= (unsigned)(h < -error) << k;
    }
    return (above & mask) == mask || (below & mask) == mask;
}

static __device__ inline void add_unit(point u, double sign, const point v)
{
    double length = sqrt(dot(v, v));
    double f = length > 0 ? sign / length : 0;
    for (int k = 0; k < 3; k++)
        u[k] += f * v[k];
}

/* Whether a plane certainly separates t and s. If they share their first
 * corner, that corner lies in the plane and the other corners lie strictly on
 * either side. */
static __device__ inline bool parted(const struct facing *f)
{
    bool shared = f->shared > 0;
    point d, u = {0, 0, 0};
    double lo = 0, hi = 0;
    for (int k = 0; k < 3; k++) {
        from(f->t[0], f->s[k], d);
        add_unit(u, shared ? 1 : 0x1p-2, d);
        from(f->t[0], f->t[k], d);
        add_unit(u, shared ? -1 : -0x1p-2, d);
    }
    bool first = true;
    for (int k = 0; k < 3; k++) {
        if (k == 0 && shared)
            continue;
        from(f->t[0], f->s[k], d);
        double h = dot(u, d), error = ERROR_PARTED * dot_size(u, d) + UNDERFLOW;
        lo = first || h - error < lo ? h - error : lo;
        from(f->t[0], f->t[k], d);
        h = dot(u, d);
        error = ERROR_PARTED * dot_size(u, d) + UNDERFLOW;
        hi = first || h + error > hi ? h + error : hi;
        first = false;
    }
    return shared ? lo > 0 && hi < 0 : lo > hi;
}

/* Whether, seen along the shared edge, the third corners certainly lie more
 * than 90° apart, so that t and s are not folded onto each other. */
static __device__ inline bool opened(const struct facing *f)
{
    point e, c, d;
    from(f->t[0], f->t[1], e);
    from(f->t[0], f->t[2], c);
    from(f->t[0], f->s[2], d);
    double p = dot(e, e) * dot(c, d), q = dot(e, c) * dot(e, d);
    double size =
        dot_size(e, e) * dot_size(c, d) + dot_size(e, c) * dot_size(e, d);
    return p - q < -(ERROR_OPENED * size + UNDERFLOW_OPENED);
}

/* Returns a mask: bit k is set if corner k of s is not a vertex of t. */
static __device__ inline unsigned others(const struct face *t,
                                         const struct face *s)
{
    unsigned r = 0;
    for (int k = 0; k < 3; k++) {
        int32_t v = s->v[k];
        r |= (unsigned)(v != t->v[0] && v != t->v[1] && v != t->v[2]) << k;
    }
    return r;
}

/* Swaps corners i and j if the key of j is less. */
static __device__ inline void order_corners(uint64_t key[3], point p[3], int i,
                                            int j)
{
    if (key[i] <= key[j])
        return;
    uint64_t k = key[i];
    key[i] = key[j];
    key[j] = k;
    for (int c = 0; c < 3; c++) {
        double x = p[i][c];
        p[i][c] = p[j][c];
        p[j][c] = x;
    }
}

/* Copies the corners of t: first those not in `mask`, by vertex number, then
 * those in `mask`. */
static __device__ inline void arrange(const struct face *t, unsigned mask,
                                      point p[3])
{
    uint64_t key[3];
    for (int k = 0; k < 3; k++) {
        key[k] = (uint64_t)(mask >> k & 1) << 32 | (uint32_t)t->v[k];
        for (int c = 0; c < 3; c++)
            p[k][c] = t->p[k][c];
    }
    order_corners(key, p, 0, 1);
    order_corners(key, p, 1, 2);
    order_corners(key, p, 0, 1);
}

static __device__ inline struct facing facing_of(const struct face *t,
                                                 unsigned left_t,
                                                 const struct face *s,
                                                 unsigned left_s)
{
    struct facing f;
    arrange(t, left_t, f.t);
    arrange(s, left_s, f.s);
    f.shared = 3 - __popc(left_t);
    return f;
}

/* True where t and s certainly do not intersect. Neither may be degenerate. */
static __device__ inline bool tritri_apart(const struct face *t,
                                           const struct face *s)
{
    unsigned left_s = others(t, s), left_t = others(s, t);
    if (left_s == 0)
        return false;
    struct plane of_t = plane_of(t);
    if (beside(&of_t, s, left_s))
        return true;
    struct plane of_s = plane_of(s);
    if (beside(&of_s, t, left_t))
        return true;
    struct facing f = facing_of(t, left_t, s, left_s);
    return f.shared == 2 ? opened(&f) : parted(&f);
}

#endif
