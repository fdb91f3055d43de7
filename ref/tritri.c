/* SPDX-License-Identifier: Apache-2.0 */
/* Whether two triangles intersect, exactly. spec/40_audit.md §3 */
#include "ref/tritri.h"

/* The coordinates that remain when the k-th is dropped. */
static const int PLANE[3][2] = {{1, 2}, {2, 0}, {0, 1}};

/* The turn of t in the first plane where it has one, that plane in *at. */
static int turn(const point t[3], int *at)
{
    for (int k = 0; k < 3; k++) {
        int s = ref_orient2(t[0], t[1], t[2], PLANE[k][0], PLANE[k][1]);
        *at = k;
        if (s != 0)
            return s;
    }
    return 0;
}

bool ref_collinear(const point t[3])
{
    int at;
    return turn(t, &at) == 0;
}

static bool same(int a, int b, int c) { return a != 0 && a == b && b == c; }

/* §3.3: segment pq, in the plane of t, meets t. */
static bool meets_in_plane(const point p, const point q, const point t[3])
{
    int at, s = turn(t, &at), u = PLANE[at][0], v = PLANE[at][1];
    for (int k = 0; k < 3; k++) {
        const double *a = t[k], *b = t[(k + 1) % 3];
        if (ref_orient2(a, b, p, u, v) == -s &&
            ref_orient2(a, b, q, u, v) == -s)
            return false;
    }
    return !same(ref_orient2(p, q, t[0], u, v), ref_orient2(p, q, t[1], u, v),
                 ref_orient2(p, q, t[2], u, v));
}

/* §3.2: segment pq, its ends on the sides sp and sq of t, meets t. */
static bool meets(const point p, int sp, const point q, int sq,
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

/* §3.2: an edge of s, its corners on the given sides of t, meets t. */
static bool edge_meets(const point s[3], const int side[3], const point t[3])
{
    for (int k = 0; k < 3; k++) {
        int l = (k + 1) % 3;
        if (meets(s[k], side[k], s[l], side[l], t))
            return true;
    }
    return false;
}

static void sides(const point t[3], const point s[3], int side[3])
{
    for (int k = 0; k < 3; k++)
        side[k] = ref_orient3(t[0], t[1], t[2], s[k]);
}

static bool apart(const point t[3], const point s[3])
{
    int of_s[3], of_t[3];
    sides(t, s, of_s);
    if (same(of_s[0], of_s[1], of_s[2]))
        return true;
    sides(s, t, of_t);
    if (same(of_t[0], of_t[1], of_t[2]))
        return true;
    return !edge_meets(s, of_s, t) && !edge_meets(t, of_t, s);
}

/* ---- §3.5 Filters for what is next to each other in a mesh ---- */

static double absolute(double a) { return a < 0 ? -a : a; }

static void from(const point o, const point p, point r)
{
    for (int k = 0; k < 3; k++)
        r[k] = p[k] - o[k];
}

static double dot(const point a, const point b)
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static double dot_size(const point a, const point b)
{
    return absolute(a[0] * b[0]) + absolute(a[1] * b[1]) +
           absolute(a[2] * b[2]);
}

/* u · v > 0 for certain, v being a rounded difference. */
static bool ahead(const point u, const point v)
{
    return dot(u, v) > 0x1p-50 * dot_size(u, v) + 0x1p-1000;
}

static void add_unit(point u, double sign, const point v)
{
    double length = sqrt(dot(v, v));
    double f = length > 0 ? sign / length : 0;
    for (int k = 0; k < 3; k++)
        u[k] += f * v[k];
}

/* A plane through the shared corner parts what remains of t and s. */
static bool parted(const point t[3], const point s[3])
{
    point a, b, c, d, u = {0, 0, 0}, w;
    from(t[0], t[1], a);
    from(t[0], t[2], b);
    from(s[0], s[1], c);
    from(s[0], s[2], d);
    add_unit(u, 1, a);
    add_unit(u, 1, b);
    add_unit(u, -1, c);
    add_unit(u, -1, d);
    for (int k = 0; k < 3; k++)
        w[k] = -u[k];
    return ahead(u, a) && ahead(u, b) && ahead(w, c) && ahead(w, d);
}

/* Across the shared edge the third corners lie more than 90° apart. */
static bool opened(const point t[3], const point s[3])
{
    point e, c, d;
    from(t[0], t[1], e);
    from(t[0], t[2], c);
    from(t[0], s[2], d);
    double p = dot(e, e) * dot(c, d), q = dot(e, c) * dot(e, d);
    double size = dot_size(e, e) * dot_size(c, d) +
                  dot_size(e, c) * dot_size(e, d);
    return p - q < -(0x1p-48 * size + 0x1p-700);
}

/* §3.4: t and s share their first two corners; they overlap. */
static bool folded(const point t[3], const point s[3])
{
    if (opened(t, s) || ref_orient3(t[0], t[1], t[2], s[2]) != 0)
        return false;
    int at, side = turn(t, &at);
    return ref_orient2(t[0], t[1], s[2], PLANE[at][0], PLANE[at][1]) == side;
}

/* §3.4: t and s share their first corner; they meet elsewhere. */
static bool crossed(const point t[3], const point s[3])
{
    if (parted(t, s))
        return false;
    int a = ref_orient3(t[0], t[1], t[2], s[1]);
    int b = ref_orient3(t[0], t[1], t[2], s[2]);
    if (meets(s[1], a, s[2], b, t))
        return true;
    a = ref_orient3(s[0], s[1], s[2], t[1]);
    b = ref_orient3(s[0], s[1], s[2], t[2]);
    return meets(t[1], a, t[2], b, s);
}

int ref_align(int32_t t[3], int32_t s[3])
{
    int shared = 0;
    for (int i = 0; i < 3; i++)
        for (int j = shared; j < 3; j++)
            if (t[i] == s[j]) {
                int32_t v = t[i];
                t[i] = t[shared];
                t[shared] = v;
                s[j] = s[shared];
                s[shared] = v;
                shared++;
                break;
            }
    return shared;
}

bool ref_tritri(const point t[3], const point s[3], int shared)
{
    if (shared == 0)
        return !apart(t, s);
    return shared == 1 ? crossed(t, s) : shared == 3 || folded(t, s);
}
