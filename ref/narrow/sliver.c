/* SPDX-License-Identifier: Apache-2.0 */
/* Decides exactly whether a degenerate triangle touches another triangle.
 * spec/narrow/audit.md §5 */
#include "ref/narrow/sliver.h"

/* Whether r lies in the closed box of p and q. */
static bool is_between(const point p, const point q, const point r)
{
    for (int k = 0; k < 3; k++) {
        bool above = r[k] > p[k] && r[k] > q[k];
        bool below = r[k] < p[k] && r[k] < q[k];
        if (above || below)
            return false;
    }
    return true;
}

static bool are_opposite(int a, int b)
{
    return a * b < 0;
}

/* §5.2: whether the closed segments pq and rs have a common point. Either
 * segment may be a point. */
static bool segments_touch(const point p, const point q, const point r,
                           const point s)
{
    if (ref_orient3(p, q, r, s) != 0)
        return false;
    bool at_p = is_between(r, s, p), at_q = is_between(r, s, q);
    bool at_r = is_between(p, q, r), at_s = is_between(p, q, s);
    for (int k = 0; k < 3; k++) {
        int u = (k + 1) % 3, v = (k + 2) % 3;
        int a = ref_orient2(p, q, r, u, v), b = ref_orient2(p, q, s, u, v);
        int c = ref_orient2(r, s, p, u, v), d = ref_orient2(r, s, q, u, v);
        if (a == 0 && b == 0 && c == 0 && d == 0)
            continue; /* the projection may put separate segments on one line */
        return (are_opposite(a, b) && are_opposite(c, d)) || (a == 0 && at_r) ||
               (b == 0 && at_s) || (c == 0 && at_p) || (d == 0 && at_q);
    }
    return at_p || at_q || at_r || at_s;
}

/* §5.3: whether p lies in t. p is in the plane of t, and t has area. */
static bool is_inside(const point p, const point t[3])
{
    for (int k = 0; k < 3; k++) {
        int u = (k + 1) % 3, v = (k + 2) % 3;
        int side = ref_orient2(t[0], t[1], t[2], u, v);
        if (side == 0)
            continue;
        return ref_orient2(t[0], t[1], p, u, v) != -side &&
               ref_orient2(t[1], t[2], p, u, v) != -side &&
               ref_orient2(t[2], t[0], p, u, v) != -side;
    }
    return false;
}

/* §5.3: whether the line pq meets t. p and q must be on opposite sides of the
 * plane of t, or one of them in the plane. */
static bool line_meets(const point p, const point q, const point t[3])
{
    int a = ref_orient3(p, q, t[0], t[1]);
    int b = ref_orient3(p, q, t[1], t[2]);
    int c = ref_orient3(p, q, t[2], t[0]);
    return !are_opposite(a, b) && !are_opposite(a, c) && !are_opposite(b, c);
}

/* Whether the closed segment pq touches t, which may be degenerate. */
static bool segment_touches(const point p, const point q, const struct face *t)
{
    const point *c = t->p;
    for (int k = 0; k < 3; k++)
        if (segments_touch(p, q, c[k], c[(k + 1) % 3]))
            return true;
    if (ref_collinear(t))
        return false;
    int a = ref_orient3(c[0], c[1], c[2], p);
    int b = ref_orient3(c[0], c[1], c[2], q);
    if (a == 0 && b == 0)
        return is_inside(p, c); /* otherwise pq would touch an edge */
    return a * b <= 0 && line_meets(p, q, c);
}

static bool has_vertex(const struct face *t, int32_t v)
{
    return t->v[0] == v || t->v[1] == v || t->v[2] == v;
}

/* Whether a corner or an edge of t that has no vertex of s touches s. */
static bool reaches_other(const struct face *t, const struct face *s)
{
    for (int k = 0; k < 3; k++) {
        int l = (k + 1) % 3;
        if (has_vertex(s, t->v[k]))
            continue;
        if (segment_touches(t->p[k], t->p[k], s))
            return true;
        if (!has_vertex(s, t->v[l]) && segment_touches(t->p[k], t->p[l], s))
            return true;
    }
    return false;
}

bool ref_sliver(const struct face *t, const struct face *s)
{
    if (reaches_other(t, s) || reaches_other(s, t))
        return true;
    for (int i = 0; i < 9; i++) {
        int k = i / 3, l = (k + 1) % 3, m = i % 3, n = (m + 1) % 3;
        bool shared = t->v[k] == s->v[m] || t->v[k] == s->v[n] ||
                      t->v[l] == s->v[m] || t->v[l] == s->v[n];
        if (!shared && segments_touch(t->p[k], t->p[l], s->p[m], s->p[n]))
            return true;
    }
    return false;
}
