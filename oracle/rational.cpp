// SPDX-License-Identifier: Apache-2.0
// Oracle of distances and intersections of primitives that do not move, in
// rational arithmetic: by clipping, and by feet of perpendiculars.
// oracle/README.md
#include "oracle/rational.h"

#include <gmpxx.h>

#include <algorithm>
#include <vector>

namespace
{

using Q = mpq_class;

struct Vec {
    Q c[3];
};

Vec read(const double x[3])
{
    return {{Q(x[0]), Q(x[1]), Q(x[2])}};
}

Vec operator-(const Vec &a, const Vec &b)
{
    return {{a.c[0] - b.c[0], a.c[1] - b.c[1], a.c[2] - b.c[2]}};
}

// a + t (b - a)
Vec between(const Vec &a, const Vec &b, const Q &t)
{
    Vec r;
    for (int k = 0; k < 3; k++)
        r.c[k] = a.c[k] + t * (b.c[k] - a.c[k]);
    return r;
}

Q dot(const Vec &a, const Vec &b)
{
    return a.c[0] * b.c[0] + a.c[1] * b.c[1] + a.c[2] * b.c[2];
}

Vec cross(const Vec &a, const Vec &b)
{
    Vec r;
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        r.c[i] = a.c[j] * b.c[k] - a.c[k] * b.c[j];
    }
    return r;
}

bool is_zero(const Vec &a)
{
    return a.c[0] == 0 && a.c[1] == 0 && a.c[2] == 0;
}

// Two triangles: one is clipped by the bounding planes of the other.

using Polygon = std::vector<Vec>;

// Clips a convex polygon, segment or point to n·(p - o) >= 0.
Polygon clip(const Polygon &p, const Vec &o, const Vec &n)
{
    Polygon r;
    for (size_t k = 0; k < p.size(); k++) {
        const Vec &a = p[k], &b = p[(k + 1) % p.size()];
        Q h = dot(n, a - o), i = dot(n, b - o);
        if (h >= 0)
            r.push_back(a);
        if ((h < 0 && i > 0) || (h > 0 && i < 0))
            r.push_back(between(a, b, h / (h - i)));
    }
    return r;
}

Vec negative(const Vec &a)
{
    return {{-a.c[0], -a.c[1], -a.c[2]}};
}

// Returns the corners of the common part; some may occur twice.
Polygon common_part(const Vec t[3], const Polygon &s)
{
    Vec n = cross(t[1] - t[0], t[2] - t[0]);
    Polygon p = clip(clip(s, t[0], n), t[0], negative(n));
    for (int k = 0; k < 3; k++)
        p = clip(p, t[k], cross(n, t[(k + 1) % 3] - t[k]));
    return p;
}

// Squared distances.

Q to_segment(const Vec &p, const Vec &a, const Vec &b)
{
    Vec d = b - a, q = p - a;
    Q l = dot(d, d), t = l == 0 ? Q(0) : Q(dot(q, d) / l);
    t = std::max(Q(0), std::min(Q(1), t));
    Vec w = p - between(a, b, t);
    return dot(w, w);
}

Q vertex_face(const Vec x[4])
{
    Vec e = x[2] - x[1], f = x[3] - x[1], q = x[0] - x[1], n = cross(e, f);
    Q least = to_segment(x[0], x[1], x[2]);
    least = std::min(least, to_segment(x[0], x[2], x[3]));
    least = std::min(least, to_segment(x[0], x[3], x[1]));
    if (is_zero(n))
        return least;
    Q nn = dot(n, n), s = dot(cross(q, f), n), t = dot(cross(e, q), n);
    if (s < 0 || t < 0 || s + t > nn)
        return least;
    Q h = dot(q, n);
    return h * h / nn;
}

Q edge_edge(const Vec x[4])
{
    Vec d = x[1] - x[0], e = x[3] - x[2], w = x[2] - x[0], n = cross(d, e);
    Q least = to_segment(x[0], x[2], x[3]);
    least = std::min(least, to_segment(x[1], x[2], x[3]));
    least = std::min(least, to_segment(x[2], x[0], x[1]));
    least = std::min(least, to_segment(x[3], x[0], x[1]));
    if (is_zero(n))
        return least;
    // The lines are nearest at the parameters s / n·n and t / n·n.
    Q nn = dot(n, n), s = dot(cross(w, e), n), t = dot(cross(w, d), n);
    if (s < 0 || s > nn || t < 0 || t > nn)
        return least;
    Q h = dot(w, n);
    return h * h / nn;
}

} // namespace

int orc_triangles(const double t[3][3], const double s[3][3], int shared)
{
    Vec a[3] = {read(t[0]), read(t[1]), read(t[2])};
    Polygon b = {read(s[0]), read(s[1]), read(s[2])};
    if (is_zero(cross(a[1] - a[0], a[2] - a[0])) ||
        is_zero(cross(b[1] - b[0], b[2] - b[0])))
        return 0;
    for (const Vec &p : common_part(a, b)) {
        Vec q = p - a[0];
        bool beyond = shared == 0 || (shared == 1 && !is_zero(q)) ||
                      (shared == 2 && !is_zero(cross(a[1] - a[0], q)));
        if (beyond || shared == 3)
            return 1;
    }
    return 0;
}

int orc_distance(int kind, const double x[4][3], double r)
{
    Vec p[4] = {read(x[0]), read(x[1]), read(x[2]), read(x[3])};
    Q d = kind == 0 ? vertex_face(p) : edge_edge(p), q(r);
    return r < 0 ? 1 : cmp(d, q * q) > 0 ? 1 : cmp(d, q * q) < 0 ? -1 : 0;
}
