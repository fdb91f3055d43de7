/* SPDX-License-Identifier: Apache-2.0 */
/* Decides exactly whether two triangles intersect, on the device.
 * spec/narrow/audit.md §3 */
#ifndef GPU_TRITRI_CUH
#define GPU_TRITRI_CUH

#include "gpu/narrow/facing.cuh"
#include "gpu/narrow/predicates.cuh"

/* Returns the orientation of t in the first coordinate plane where it is not 0.
 * That plane has the coordinates u = *at + 1 and v = *at + 2, modulo 3. */
static __device__ inline int orientation(struct signs *w, const point t[3],
                                         int *at)
{
    for (*at = 0; *at < 3; ++*at) {
        int s = orient2(w, t[0], t[1], t[2], (*at + 1) % 3, (*at + 2) % 3);
        if (s)
            return s;
    }
    return 0;
}

static __device__ inline bool same(int a, int b, int c)
{
    return a != 0 && a == b && b == c;
}

/* §3.3: whether segment pq meets t. pq lies in the plane of t. */
static __device__ __noinline__ bool
meets_in_plane(struct signs *w, const point p, const point q, const point t[3])
{
    int at, s = orientation(w, t, &at), u = (at + 1) % 3, v = (at + 2) % 3;
    for (int k = 0; k < 3; k++) {
        const double *a = t[k], *b = t[(k + 1) % 3];
        if (orient2(w, a, b, p, u, v) == -s && orient2(w, a, b, q, u, v) == -s)
            return false;
    }
    return !same(orient2(w, p, q, t[0], u, v), orient2(w, p, q, t[1], u, v),
                 orient2(w, p, q, t[2], u, v));
}

/* §3.2: whether segment pq meets t. p and q are on the sides sp and sq of the
 * plane of t. */
static __device__ __noinline__ bool meets(struct signs *w, const point p,
                                          int sp, const point q, int sq,
                                          const point t[3])
{
    if (sp * sq > 0)
        return false;
    if (sp == 0 && sq == 0)
        return !w->unsure && meets_in_plane(w, p, q, t);
    int a = orient3(w, p, q, t[0], t[1]), b = orient3(w, p, q, t[1], t[2]);
    if (a * b < 0)
        return false;
    int c = orient3(w, p, q, t[2], t[0]);
    return a * c >= 0 && b * c >= 0;
}

/* Finds the sides of the plane of t on which the corners of s lie. */
static __device__ inline void sides(struct signs *w, const point t[3],
                                    const point s[3], int side[3])
{
    for (int k = 0; k < 3; k++)
        side[k] = orient3(w, t[0], t[1], t[2], s[k]);
}

static __device__ inline bool edge_meets(struct signs *w, const point s[3],
                                         const int side[3], const point t[3])
{
    return meets(w, s[0], side[0], s[1], side[1], t) ||
           meets(w, s[1], side[1], s[2], side[2], t) ||
           meets(w, s[2], side[2], s[0], side[0], t);
}

/* §3.1: whether t and s, which share no vertex, intersect. */
static __device__ inline bool met(struct signs *w, const struct facing *f)
{
    int of_s[3], of_t[3];
    sides(w, f->t, f->s, of_s);
    if (same(of_s[0], of_s[1], of_s[2]))
        return false;
    sides(w, f->s, f->t, of_t);
    if (same(of_t[0], of_t[1], of_t[2]))
        return false;
    return edge_meets(w, f->s, of_s, f->t) || edge_meets(w, f->t, of_t, f->s);
}

/* §3.4: whether t and s, which share their first corner, have another common
 * point. */
static __device__ inline bool crossed(struct signs *w, const struct facing *f)
{
    int a = orient3(w, f->t[0], f->t[1], f->t[2], f->s[1]);
    int b = orient3(w, f->t[0], f->t[1], f->t[2], f->s[2]);
    if (meets(w, f->s[1], a, f->s[2], b, f->t))
        return true;
    a = orient3(w, f->s[0], f->s[1], f->s[2], f->t[1]);
    b = orient3(w, f->s[0], f->s[1], f->s[2], f->t[2]);
    return meets(w, f->t[1], a, f->t[2], b, f->s);
}

/* §3.4: whether t and s, which share their first two corners, overlap. */
static __device__ inline bool folded(struct signs *w, const struct facing *f)
{
    if (orient3(w, f->t[0], f->t[1], f->t[2], f->s[2]))
        return false;
    int at, side = orientation(w, f->t, &at);
    return orient2(w, f->t[0], f->t[1], f->s[2], (at + 1) % 3, (at + 2) % 3) ==
           side;
}

/* Whether the triangles intersect, for pairs that the filters leave
 * undecided. */
static __device__ inline bool tritri_decide(struct signs *w,
                                            const struct facing *f)
{
    return f->shared == 3   ? true
           : f->shared == 2 ? folded(w, f)
           : f->shared == 1 ? crossed(w, f)
                            : met(w, f);
}

#endif
