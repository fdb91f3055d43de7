/* SPDX-License-Identifier: Apache-2.0 */
/* Decides exactly whether two triangles intersect. spec/narrow/audit.md §3 */
#include "ref/narrow/tritri.h"

/* Error bounds of §3.5, proven in spec/proofs/audit_*.gappa. Each is a multiple
 * of the sum of the terms' magnitudes. */
#define ERROR_BESIDE 0x1p-49
#define ERROR_PARTED 0x1p-49
#define ERROR_OPENED 0x1p-48
#define UNDERFLOW 0x1p-1000       /* bounds the loss by underflow */
#define UNDERFLOW_OPENED 0x1p-700 /* the same for products of four factors */

/* PLANE[k] holds the two coordinates that remain when coordinate k is
 * dropped. */
static const int PLANE[3][2] = {{1, 2}, {2, 0}, {0, 1}};

/* Returns the orientation of t in the first coordinate plane where it is not 0,
 * and that plane in *at. Returns 0 if t is degenerate. */
static int find_orientation(const point t[3], int *at)
{
    for (int k = 0; k < 3; k++) {
        int s = ref_orient2(t[0], t[1], t[2], PLANE[k][0], PLANE[k][1]);
        *at = k;
        if (s != 0)
            return s;
    }
    return 0;
}

bool ref_collinear(const struct face *t)
{
    int at;
    return find_orientation(t->p, &at) == 0;
}

static bool same_signs(int a, int b, int c)
{
    return a != 0 && a == b && b == c;
}

/* §3.3: whether segment pq meets t. pq lies in the plane of t. */
static bool meets_in_plane(const point p, const point q, const point t[3])
{
    int at, s = find_orientation(t, &at), u = PLANE[at][0], v = PLANE[at][1];
    for (int k = 0; k < 3; k++) {
        const double *a = t[k], *b = t[(k + 1) % 3];
        if (ref_orient2(a, b, p, u, v) == -s &&
            ref_orient2(a, b, q, u, v) == -s)
            return false;
    }
    return !same_signs(ref_orient2(p, q, t[0], u, v),
                       ref_orient2(p, q, t[1], u, v),
                       ref_orient2(p, q, t[2], u, v));
}

/* §3.2: whether segment pq meets t. p and q are on the sides sp and sq of the
 * plane of t. */
static bool segment_meets(const point p, int sp, const point q, int sq,
                          const point t[3])
{
    if (sp * sq > 0)
        return false;
    if (sp == 0 && sq == 0)
        return meets_in_plane(p, q, t);
    int a = ref_orient3(p, q, t[0], t[1]);
    int b = ref_orient3(p, q, t[1], t[2]);
    if (a * b < 0)
        return false;
    int c = ref_orient3(p, q, t[2], t[0]);
    return a * c >= 0 && b * c >= 0;
}

/* §3.2: whether an edge of s meets t. side[k] is the side of the plane of t on
 * which corner k of s lies. */
static bool edge_meets(const point s[3], const int side[3], const point t[3])
{
    for (int k = 0; k < 3; k++) {
        int l = (k + 1) % 3;
        if (segment_meets(s[k], side[k], s[l], side[l], t))
            return true;
    }
    return false;
}

static void find_sides(const point t[3], const point s[3], int side[3])
{
    for (int k = 0; k < 3; k++)
        side[k] = ref_orient3(t[0], t[1], t[2], s[k]);
}

static bool are_apart(const point t[3], const point s[3])
{
    int of_s[3], of_t[3];
    find_sides(t, s, of_s);
    if (same_signs(of_s[0], of_s[1], of_s[2]))
        return true;
    find_sides(s, t, of_t);
    if (same_signs(of_t[0], of_t[1], of_t[2]))
        return true;
    return !edge_meets(s, of_s, t) && !edge_meets(t, of_t, s);
}

/* §3.4: the shared vertices come first in t and in s, in the same order. */

/* Whether t and s, which share their first two corners, overlap. */
static bool is_folded(const point t[3], const point s[3])
{
    if (ref_orient3(t[0], t[1], t[2], s[2]) != 0)
        return false;
    int at, side = find_orientation(t, &at);
    return ref_orient2(t[0], t[1], s[2], PLANE[at][0], PLANE[at][1]) == side;
}

/* Whether t and s, which share their first corner, have another common
 * point. */
static bool is_crossed(const point t[3], const point s[3])
{
    int a = ref_orient3(t[0], t[1], t[2], s[1]);
    int b = ref_orient3(t[0], t[1], t[2], s[2]);
    if (segment_meets(s[1], a, s[2], b, t))
        return true;
    a = ref_orient3(s[0], s[1], s[2], t[1]);
    b = ref_orient3(s[0], s[1], s[2], t[2]);
    return segment_meets(t[1], a, t[2], b, s);
}

/* §3.5: filters. Their answers are certain although their numbers are
 * rounded. */

static void subtract_points(const point o, const point p, point r)
{
    for (int k = 0; k < 3; k++)
        r[k] = p[k] - o[k];
}

static double dot_points(const point a, const point b)
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static double dot_size(const point a, const point b)
{
    return fabs(a[0] * b[0]) + fabs(a[1] * b[1]) + fabs(a[2] * b[2]);
}

/* Returns a mask: bit k is set if corner k of s is not a vertex of t. */
static unsigned mask_of_others(const struct face *t, const struct face *s)
{
    unsigned r = 0;
    for (int k = 0; k < 3; k++) {
        int32_t v = s->v[k];
        r |= (unsigned)((v != t->v[0]) & (v != t->v[1]) & (v != t->v[2])) << k;
    }
    return r;
}

struct plane ref_plane(const struct face *t)
{
    struct plane r;
    point a, b;
    subtract_points(t->p[0], t->p[1], a);
    subtract_points(t->p[0], t->p[2], b);
    for (int k = 0; k < 3; k++) {
        double p = a[PLANE[k][0]] * b[PLANE[k][1]];
        double q = a[PLANE[k][1]] * b[PLANE[k][0]];
        r.o[k] = t->p[0][k];
        r.n[k] = p - q;
        r.size[k] = fabs(p) + fabs(q);
    }
    return r;
}

/* Whether the corners of s in `mask` certainly lie on one side of the plane of
 * t. */
static bool is_one_sided(const struct plane *t, const struct face *s,
                         unsigned mask)
{
    point d;
    unsigned above = 0, below = 0;
    for (int k = 0; k < 3; k++) {
        subtract_points(t->o, s->p[k], d);
        double h = dot_points(t->n, d);
        double err = ERROR_BESIDE * dot_size(t->size, d) + UNDERFLOW;
        above |= (unsigned)(h > err) << k;
        below |= (unsigned)(h < -err) << k;
    }
    return (above & mask) == mask || (below & mask) == mask;
}

static void add_unit(point u, double sign, const point v)
{
    double length = sqrt(dot_points(v, v));
    double f = length > 0 ? sign / length : 0;
    for (int k = 0; k < 3; k++)
        u[k] += f * v[k];
}

/* Whether a plane certainly separates t and s. If they share their first
 * corner, that corner lies in the plane and the other corners lie strictly on
 * either side. */
static bool is_parted(const point t[3], const point s[3], int shared)
{
    point d, u = {0, 0, 0};
    double lo = 0, hi = 0;
    for (int k = 0; k < 3; k++) {
        subtract_points(t[0], s[k], d);
        add_unit(u, shared ? 1 : 0x1p-2, d);
        subtract_points(t[0], t[k], d);
        add_unit(u, shared ? -1 : -0x1p-2, d);
    }
    for (int k = shared; k < 3; k++) {
        subtract_points(t[0], s[k], d);
        double h = dot_points(u, d),
               err = ERROR_PARTED * dot_size(u, d) + UNDERFLOW;
        lo = k == shared || h - err < lo ? h - err : lo;
        subtract_points(t[0], t[k], d);
        h = dot_points(u, d), err = ERROR_PARTED * dot_size(u, d) + UNDERFLOW;
        hi = k == shared || h + err > hi ? h + err : hi;
    }
    return shared ? lo > 0 && hi < 0 : lo > hi;
}

/* Whether, seen along the shared edge, the third corners certainly lie more
 * than 90° apart, so that t and s are not folded onto each other. */
static bool is_opened(const point t[3], const point s[3])
{
    point e, c, d;
    subtract_points(t[0], t[1], e);
    subtract_points(t[0], t[2], c);
    subtract_points(t[0], s[2], d);
    double p = dot_points(e, e) * dot_points(c, d),
           q = dot_points(e, c) * dot_points(e, d);
    double size =
        dot_size(e, e) * dot_size(c, d) + dot_size(e, c) * dot_size(e, d);
    return p - q < -(ERROR_OPENED * size + UNDERFLOW_OPENED);
}

/* Copies the corners of t: first those not in `mask`, by vertex number, then
 * those in `mask`. */
static void arrange_corners(const struct face *t, unsigned mask, point r[3])
{
    int order[3] = {0, 1, 2};
    for (int k = 0; k < 3; k++)
        for (int j = k; j > 0; j--) {
            int a = order[j - 1], b = order[j];
            bool last_a = mask >> a & 1, last_b = mask >> b & 1;
            if (last_a > last_b || (last_a == last_b && t->v[a] > t->v[b])) {
                order[j - 1] = b;
                order[j] = a;
            }
        }
    for (int k = 0; k < 3; k++)
        memcpy(r[k], t->p[order[k]], sizeof r[k]);
}

bool ref_tritri(const struct face *t, const struct plane *of_t,
                const struct face *s)
{
    unsigned left_s = mask_of_others(t, s);
    if (left_s == 0)
        return true;
    if (is_one_sided(of_t, s, left_s))
        return false;
    unsigned left_t = mask_of_others(s, t);
    struct plane of_s = ref_plane(s);
    if (is_one_sided(&of_s, t, left_t))
        return false;

    point p[3], q[3];
    arrange_corners(t, left_t, p);
    arrange_corners(s, left_s, q);
    const point *a = (const point *)p, *b = (const point *)q;
    int shared = 3 - (int)((left_t & 1) + (left_t >> 1 & 1) + (left_t >> 2));
    if (shared == 2)
        return !is_opened(a, b) && is_folded(a, b);
    if (is_parted(a, b, shared))
        return false;
    return shared == 1 ? is_crossed(a, b) : !are_apart(a, b);
}
