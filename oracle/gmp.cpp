// SPDX-License-Identifier: Apache-2.0
// Oracle of continuous collision detection by GMP integers and Sturm-Tarski
// queries: no root is ever approximated. oracle/README.md says why its answers
// are taken as the truth.
#include "oracle/oracle.h"

#include <gmpxx.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace
{

using Z = mpz_class;

// Polynomials over the integers, c[i] t^i, without leading zeros.

using Poly = std::vector<Z>;

void trim(Poly &p)
{
    while (!p.empty() && p.back() == 0)
        p.pop_back();
}

Poly combine(const Poly &a, const Poly &b, int sign)
{
    Poly r(std::max(a.size(), b.size()));
    for (size_t i = 0; i < a.size(); i++)
        r[i] = a[i];
    for (size_t i = 0; i < b.size(); i++) {
        if (sign > 0)
            r[i] += b[i];
        else
            r[i] -= b[i];
    }
    trim(r);
    return r;
}

Poly operator+(const Poly &a, const Poly &b)
{
    return combine(a, b, 1);
}
Poly operator-(const Poly &a, const Poly &b)
{
    return combine(a, b, -1);
}

Poly operator*(const Poly &a, const Poly &b)
{
    Poly r(a.empty() || b.empty() ? 0 : a.size() + b.size() - 1);
    for (size_t i = 0; i < a.size(); i++)
        for (size_t j = 0; j < b.size(); j++)
            mpz_addmul(r[i + j].get_mpz_t(), a[i].get_mpz_t(),
                       b[j].get_mpz_t());
    trim(r);
    return r;
}

Poly negative(const Poly &a)
{
    return Poly() - a;
}

Poly derivative(const Poly &a)
{
    Poly r(a.empty() ? 0 : a.size() - 1);
    for (size_t i = 1; i < a.size(); i++)
        r[i - 1] = a[i] * (unsigned long)i;
    return r;
}

// Divides by the positive greatest common divisor of the coefficients.
void make_primitive(Poly &a)
{
    Z g = 0;
    for (const Z &c : a)
        g = gcd(g, c);
    if (g > 1)
        for (Z &c : a)
            c /= g;
}

// Returns a positive multiple of the remainder of a by b.
Poly remainder(Poly a, const Poly &b)
{
    while (a.size() >= b.size()) {
        // a <- |lead b| a - (sign) lead a t^k b
        Z lead = a.back(), scale = abs(b.back());
        if (b.back() < 0)
            lead = -lead;
        size_t shift = a.size() - b.size();
        for (Z &c : a)
            c *= scale;
        for (size_t i = 0; i < b.size(); i++)
            a[i + shift] -= lead * b[i];
        trim(a);
    }
    make_primitive(a);
    return a;
}

Poly common_divisor(Poly a, Poly b)
{
    while (!b.empty()) {
        Poly r = remainder(a, b);
        a = std::move(b);
        b = std::move(r);
    }
    make_primitive(a);
    return a;
}

// The dyadic number k / 2^s.
struct Dyadic {
    Z k;
    unsigned long s;
};

int sign_at(const Poly &p, const Dyadic &x)
{
    if (p.empty())
        return 0;
    Z sum = p.back();
    unsigned long shift = 0;
    for (size_t i = p.size() - 1; i-- > 0;) {
        shift += x.s;
        sum = sum * x.k + (p[i] << shift);
    }
    return sgn(sum);
}

// Returns p divided by all its roots at x.
Poly deflate(Poly p, const Dyadic &x)
{
    const Z lead = Z(1) << x.s; // p = (2^s t - k) q
    while (p.size() > 1 && sign_at(p, x) == 0) {
        Poly q(p.size() - 1);
        // Scales by so many twos that every division is exact.
        for (Z &c : p)
            c <<= x.s * (unsigned long)p.size();
        for (size_t i = p.size() - 1; i > 0; i--) {
            q[i - 1] = p[i] / lead;
            p[i - 1] += q[i - 1] * x.k;
        }
        make_primitive(q);
        p = std::move(q);
    }
    return p;
}

// The signed remainder sequence of e and e' g, for Tarski queries.
struct Chain {
    std::vector<Poly> p;

    Chain(const Poly &e, const Poly &g)
    {
        p.push_back(e);
        Poly next = remainder(derivative(e) * g, e);
        while (!next.empty()) {
            p.push_back(std::move(next));
            next = negative(remainder(p[p.size() - 2], p.back()));
        }
    }
    int changes(const Dyadic &x) const
    {
        int n = 0, last = 0;
        for (const Poly &q : p) {
            int s = sign_at(q, x);
            n += s * last < 0;
            last = s != 0 ? s : last;
        }
        return n;
    }
    // Returns the sum of the signs of g over the roots of e in (a, b); e(a) and
    // e(b) must not be 0.
    int query(const Dyadic &a, const Dyadic &b) const
    {
        return changes(a) - changes(b);
    }
};

struct Condition {
    Poly g;
    bool strict; // g > 0, else g >= 0
};

using Conditions = std::vector<Condition>;

bool good(int sign, const Condition &c)
{
    return c.strict ? sign > 0 : sign >= 0;
}

bool hold_at(const Conditions &conditions, const Dyadic &x)
{
    return std::all_of(
        conditions.begin(), conditions.end(),
        [&](const Condition &c) { return good(sign_at(c.g, x), c); });
}

// floor(2^30 x)
uint32_t level(const Dyadic &x)
{
    Z r = x.k << 30;
    r >>= x.s;
    return (uint32_t)r.get_ui();
}

Dyadic middle_of(const Dyadic &a)
{
    return {a.k * 2 + 1, a.s + 1};
}
Dyadic left_of(const Dyadic &a)
{
    return {a.k * 2, a.s + 1};
}
Dyadic right_of(const Dyadic &a)
{
    return {a.k * 2 + 2, a.s + 1};
}

// Returns the grid cell of the only root of e in (a, a + 2^-a.s).
uint32_t refine(const Poly &e, const Chain &chain, Dyadic a)
{
    // At a root of even multiplicity e keeps its sign; only the chain shows it.
    int from = sign_at(e, a);
    bool odd = sign_at(e, {a.k + 1, a.s}) != from;
    while (a.s < 30) {
        Dyadic middle = middle_of(a);
        int sign = sign_at(e, middle);
        if (sign == 0)
            return level(middle);
        bool left = odd ? sign != from : chain.query(left_of(a), middle) == 1;
        a = left ? left_of(a) : middle;
    }
    return level(a);
}

// Finds the first root of e in (a, b), b = a + 2^-a.s, at which all conditions
// hold; e(a) and e(b) must not be 0.
uint32_t first_between(Poly e, const Conditions &conditions, const Dyadic &a,
                       const Dyadic &b)
{
    if (e.size() < 2)
        return ORC_NEVER;
    Chain chain(e, Poly{1});
    int roots = chain.query(a, b);
    if (roots == 0)
        return ORC_NEVER;
    if (roots == 1) {
        for (const Condition &c : conditions)
            if (!good(Chain(e, c.g).query(a, b), c))
                return ORC_NEVER;
        return refine(e, chain, a);
    }
    Dyadic middle = middle_of(a);
    bool at_middle = sign_at(e, middle) == 0;
    e = deflate(e, middle);
    uint32_t first = first_between(e, conditions, left_of(a), middle);
    if (first == ORC_NEVER && at_middle && hold_at(conditions, middle))
        first = level(middle);
    if (first == ORC_NEVER)
        first = first_between(e, conditions, middle, right_of(a));
    return first;
}

// Finds the first such root in (0, 1].
uint32_t first_root(Poly e, const Conditions &conditions)
{
    Dyadic zero{0, 0}, one{1, 0};
    e = deflate(e, zero);
    bool at_one = e.size() > 1 && sign_at(e, one) == 0;
    if (at_one)
        e = deflate(e, one);
    uint32_t first = first_between(e, conditions, zero, one);
    if (first == ORC_NEVER && at_one && hold_at(conditions, one))
        first = level(one);
    return first;
}

struct Vec {
    Poly c[3];
};

Vec operator-(const Vec &a, const Vec &b)
{
    return {{a.c[0] - b.c[0], a.c[1] - b.c[1], a.c[2] - b.c[2]}};
}

Poly dot(const Vec &a, const Vec &b)
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

// Positions as integers, all in units of one power of two.
void read(const double x0[4][3], const double x1[4][3], Vec p[4])
{
    int least = 0;
    const double *x[2] = {&x0[0][0], &x1[0][0]};
    Z m[2][12];
    int e[2][12];
    for (int k = 0; k < 24; k++) {
        double f = std::frexp(x[k / 12][k % 12], &e[k / 12][k % 12]);
        m[k / 12][k % 12] = std::ldexp(f, 53);
        int bottom = f == 0 ? 0 : e[k / 12][k % 12] - 53;
        least = k == 0 ? bottom : std::min(least, bottom);
    }
    for (int k = 0; k < 12; k++) {
        for (int i = 0; i < 2; i++)
            m[i][k] <<= m[i][k] == 0 ? 0 : e[i][k] - 53 - least;
        Poly &c = p[k / 3].c[k % 3];
        c = {m[0][k], m[1][k] - m[0][k]};
        trim(c);
    }
}

// Whether the Bernstein form of f, of degree 3 times 3, proves that f has one
// sign, not 0, on all of [0, 1].
bool one_sign(Poly f)
{
    f.resize(4);
    Z b1 = 3 * f[0] + f[1], b2 = 3 * f[0] + 2 * f[1] + f[2];
    Z b3 = f[0] + f[1] + f[2] + f[3];
    int s = sgn(f[0]);
    return s != 0 && sgn(b1) == s && sgn(b2) == s && sgn(b3) == s;
}

// A possible contact: a root of e at which conditions hold.
struct Event {
    Poly e;
    Conditions conditions;
};

// p lies on the closed segment q r.
Event on_segment(const Vec &p, const Vec &q, const Vec &r)
{
    Vec a = q - p, b = r - p, w = cross(a, b);
    Poly h = dot(a, b);
    Event v;
    v.e = common_divisor(common_divisor(w.c[0], w.c[1]), w.c[2]);
    v.conditions = {{negative(h), false}};
    if (v.e.empty()) // always on one line: contact begins where h = 0
        v.e = h;
    return v;
}

bool on_segment_at_0(const Vec &p, const Vec &q, const Vec &r)
{
    Vec a = q - p, b = r - p, w = cross(a, b);
    Dyadic zero{0, 0};
    for (const Poly &c : w.c)
        if (sign_at(c, zero) != 0)
            return false;
    return sign_at(dot(a, b), zero) <= 0;
}

// The normal of the face, or the cross product of the edges' directions.
Vec normal(int kind, const Vec p[4])
{
    return kind == 0 ? cross(p[2] - p[1], p[3] - p[1])
                     : cross(p[1] - p[0], p[3] - p[2]);
}

// Vertex p[0] is within face p[1] p[2] p[3] when all four are coplanar.
Conditions in_face(const Vec p[4], const Vec &n)
{
    Conditions c{{dot(n, n), true}};
    for (int k = 0; k < 3; k++) {
        Vec a = p[1 + k] - p[0], b = p[1 + (k + 1) % 3] - p[0];
        c.push_back({dot(n, cross(a, b)), false});
    }
    return c;
}

// Edges p[0] p[1] and p[2] p[3] cross when they are coplanar.
Conditions crossing(const Vec p[4], const Vec &n)
{
    Vec d = p[1] - p[0], e = p[3] - p[2];
    return {{dot(n, n), true},
            {dot(n, cross(p[2] - p[0], d)), false},
            {dot(n, cross(d, p[3] - p[0])), false},
            {dot(n, cross(e, p[0] - p[2])), false},
            {dot(n, cross(p[1] - p[2], e)), false}};
}

// The pairs of points and segments whose contact is a contact of the pair.
const int BORDER[2][4][3] = {{{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {0, 3, 1}},
                             {{0, 2, 3}, {1, 2, 3}, {2, 0, 1}, {3, 0, 1}}};

uint32_t first_contact(int kind, const Vec p[4])
{
    Vec n = normal(kind, p);
    Event main{dot(n, p[kind == 0 ? 0 : 2] - p[kind == 0 ? 1 : 0]), {}};
    if (one_sign(main.e))
        return ORC_NEVER;
    main.conditions = kind == 0 ? in_face(p, n) : crossing(p, n);
    Dyadic zero{0, 0};
    if (sign_at(main.e, zero) == 0 && hold_at(main.conditions, zero))
        return 0;
    for (const auto &b : BORDER[kind])
        if (on_segment_at_0(p[b[0]], p[b[1]], p[b[2]]))
            return 0;
    // Contact needs all points in one plane. If they always are, contact begins
    // at a border, and so it may where n is 0 at a root of the cubic.
    uint32_t first = first_root(main.e, main.conditions);
    const Poly &n2 = main.conditions[0].g;
    if (!main.e.empty() && common_divisor(main.e, n2).size() == 1)
        return first;
    for (const auto &b : BORDER[kind]) {
        Event v = on_segment(p[b[0]], p[b[1]], p[b[2]]);
        first = std::min(first, first_root(v.e, v.conditions));
    }
    return first;
}

} // namespace

int orc_ccd_gmp(int kind, const double x0[4][3], const double x1[4][3],
                uint32_t *toi)
{
    Vec p[4];
    read(x0, x1, p);
    *toi = first_contact(kind, p);
    return *toi != ORC_NEVER;
}

int orc_present(void)
{
    return 1;
}
