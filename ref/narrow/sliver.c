/* SPDX-License-Identifier: Apache-2.0 */
/* Whether a triangle without area touches another, exactly.
 * spec/narrow/audit.md §5 */
#include "ref/narrow/sliver.h"

/* Whether r lies in the box of p and q. */
static bool between(const point p, const point q, const point r)
{
    for (int k = 0; k < 3; k++) {
        bool above = r[k] > p[k] && r[k] > q[k];
        bool below = r[k] < p[k] && r[k] < q[k];
        if (above || below)
            return false;
    }
    return true;
}

static bool opposite(int a, int b)
{
    return a * b < 0;
}

/* §5.2: the closed segments pq and rs, each maybe a point, have a common one.
 */
static bool segments_touch(const point p, const point q, const point r,
                           const point s)
{
    if (ref_orient3(p, q, r, s) != 0)
        return false;
    bool at_p = between(r, s, p), at_q = between(r, s, q);
    bool at_r = between(p, q, r), at_s = between(p, q, s);
    for (int k = 0; k < 3; k++) {
        int u = (k + 1) % 3, v = (k + 2) % 3;
        int a = ref_orient2(p, q, r, u, v), b = ref_orient2(p, q, s, u, v);
        int c = ref_orient2(r, s, p, u, v), d = ref_orient2(r, s, q, u, v);
        if (a == 0 && b == 0 && c == 0 && d == 0)
            continue; /* this projection may lay what is apart on one line */
        return (opposite(a, b) && opposite(c, d)) || (a == 0 && at_r) ||
               (b == 0 && at_s) || (c == 0 && at_p) || (d == 0 && at_q);
    }
    return at_p || at_q || at_r || at_s;
}

/* §5.3: p, in the plane of t, lies in t, which has area. */
static bool inside(const point p, const point t[3])
{
    for (int k = 0; k < 3; k++) {
        int u = (k + 1) % 3, v = (k + 2) % 3;
        int turn = ref_orient2(t[0], t[1], t[2], u, v);
        if (turn == 0)
            continue;
        return ref_orient2(t[0], t[1], p, u, v) != -turn &&
               ref_orient2(t[1], t[2], p, u, v) != -turn &&
               ref_orient2(t[2], t[0], p, u, v) != -turn;
    }
    return false;
}

/* §5.3: the line pq, not in the plane of t, which parts p from q or has one of
 * them in it, meets t. */
static bool crosses(const point p, const point q, const point t[3])
{
    int a = ref_orient3(p, q, t[0], t[1]);
    int b = ref_orient3(p, q, t[1], t[2]);
    int c = ref_orient3(p, q, t[2], t[0]);
    return !opposite(a, b) && !opposite(a, c) && !opposite(b, c);
}

/* The segment pq touches t, of whatever area. */
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
        return inside(p, c); /* else it would touch an edge */
    return a * b <= 0 && crosses(p, q, c);
}

static bool has(const struct face *t, int32_t v)
{
    return t->v[0] == v || t->v[1] == v || t->v[2] == v;
}

/* A corner or an edge of t, of which no vertex is one of s, touches s. */
static bool reaches(const struct face *t, const struct face *s)
{
    for (int k = 0; k < 3; k++) {
        int l = (k + 1) % 3;
        if (has(s, t->v[k]))
            continue;
        if (segment_touches(t->p[k], t->p[k], s))
            return true;
        if (!has(s, t->v[l]) && segment_touches(t->p[k], t->p[l], s))
            return true;
    }
    return false;
}

bool ref_sliver(const struct face *t, const struct face *s)
{
    if (reaches(t, s) || reaches(s, t))
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
