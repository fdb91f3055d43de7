// SPDX-License-Identifier: Apache-2.0
// Oracle of continuous collision detection by CGAL's algebraic numbers: finds
// the roots of the coplanarity cubic and exact signs at them. oracle/README.md
#include "oracle/oracle.h"

#include <CGAL/Algebraic_kernel_d_1.h>
#include <CGAL/CORE_BigInt.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace
{

using Integer = CORE::BigInt;
using Kernel = CGAL::Algebraic_kernel_d_1<Integer>;
using Poly = Kernel::Polynomial_1;
using Time = Kernel::Algebraic_real_1;
using Rational = Kernel::Bound;

struct Vec {
    Poly c[3];
};

Vec operator-(const Vec &a, const Vec &b)
{
    return {{a.c[0] - b.c[0], a.c[1] - b.c[1], a.c[2] - b.c[2]}};
}

// Component k of a × b.
Poly cross(const Vec &a, const Vec &b, int k)
{
    int i = (k + 1) % 3, j = (k + 2) % 3;
    return a.c[i] * b.c[j] - a.c[j] * b.c[i];
}

Poly triple(const Vec &a, const Vec &b, const Vec &c)
{
    return cross(a, b, 0) * c.c[0] + cross(a, b, 1) * c.c[1] +
           cross(a, b, 2) * c.c[2];
}

int sign_at(const Poly &p, const Rational &x)
{
    Rational sum(0);
    for (int k = CGAL::degree(p); k >= 0; k--)
        sum = sum * x + Rational(p[k]);
    return (int)CGAL::sign(sum);
}

// Replaces CGAL 5.5's Sign_at_1, which throws if refining an interval hits the
// root exactly, because the root is then stored as a rational number.
int sign_at(const Poly &p, const Time &t)
{
    if (CGAL::is_zero(p) || Kernel().is_zero_at_1_object()(p, t))
        return 0;
    for (;; t.refine()) {
        const Rational low = t.low(), high = t.high();
        int sign = sign_at(p, low);
        if (low == high)
            return sign;
        if (sign != 0 && sign == sign_at(p, high) &&
            CGAL::internal::descartes(p, low, high) == 0)
            return sign;
    }
}

// Whether p lies on the closed segment q r: on its line and not beyond an end.
bool on_segment(const Vec &p, const Vec &q, const Vec &r, const Time &t)
{
    Vec a = q - p, b = r - p;
    for (int k = 0; k < 3; k++)
        if (sign_at(cross(a, b, k), t) != 0 || sign_at(a.c[k] * b.c[k], t) > 0)
            return false;
    return true;
}

// Returns the turn of a b c seen along axis k.
int turn(const Vec &a, const Vec &b, const Vec &c, int k, const Time &t)
{
    return sign_at(cross(b - a, c - a, k), t);
}

// Returns an axis on which a × b is not 0, or -1.
int axis_of(const Vec &a, const Vec &b, const Time &t)
{
    for (int k = 0; k < 3; k++)
        if (sign_at(cross(a, b, k), t) != 0)
            return k;
    return -1;
}

bool vertex_face(const Vec p[4], const Time &t)
{
    Vec a = p[2] - p[1], b = p[3] - p[1];
    int k = axis_of(a, b, t);
    if (k < 0)
        return on_segment(p[0], p[1], p[2], t) ||
               on_segment(p[0], p[2], p[3], t) ||
               on_segment(p[0], p[3], p[1], t);
    int side = sign_at(cross(a, b, k), t);
    return sign_at(triple(a, b, p[0] - p[1]), t) == 0 &&
           side * turn(p[1], p[2], p[0], k, t) >= 0 &&
           side * turn(p[2], p[3], p[0], k, t) >= 0 &&
           side * turn(p[3], p[1], p[0], k, t) >= 0;
}

bool edge_edge(const Vec p[4], const Time &t)
{
    Vec a = p[1] - p[0], b = p[3] - p[2];
    int k = axis_of(a, b, t);
    if (k < 0)
        return on_segment(p[0], p[2], p[3], t) ||
               on_segment(p[1], p[2], p[3], t) ||
               on_segment(p[2], p[0], p[1], t) ||
               on_segment(p[3], p[0], p[1], t);
    return sign_at(triple(a, b, p[2] - p[0]), t) == 0 &&
           turn(p[0], p[1], p[2], k, t) * turn(p[0], p[1], p[3], k, t) <= 0 &&
           turn(p[2], p[3], p[0], k, t) * turn(p[2], p[3], p[1], k, t) <= 0;
}

void add_roots(const Poly &p, std::vector<Time> &times)
{
    if (CGAL::is_zero(p) || CGAL::degree(p) == 0)
        return;
    std::vector<std::pair<Time, Kernel::Multiplicity_type>> roots;
    Kernel().solve_1_object()(p, Rational(0), Rational(1),
                              std::back_inserter(roots));
    for (auto &r : roots)
        times.push_back(r.first);
}

// Returns every time at which contact can begin, ascending.
std::vector<Time> candidates(int kind, const Vec p[4])
{
    std::vector<Time> times{Time(0)};
    Poly f = kind == 0 ? triple(p[2] - p[1], p[3] - p[1], p[0] - p[1])
                       : triple(p[1] - p[0], p[3] - p[2], p[2] - p[0]);
    add_roots(f, times);
    // If the points are always in one plane, contact begins where a point meets
    // the end of a segment or its line, or where three points are on a line.
    for (int i = 0; i < 4 && CGAL::is_zero(f); i++)
        for (int j = 0; j < 4; j++)
            for (int k = j + 1; k < 4; k++)
                for (int c = 0; c < 3 && i != j && i != k; c++) {
                    add_roots(cross(p[j] - p[i], p[k] - p[i], c), times);
                    add_roots(p[j].c[c] - p[i].c[c], times);
                    add_roots(p[k].c[c] - p[i].c[c], times);
                }
    std::sort(times.begin(), times.end());
    return times;
}

// floor(2^30 t)
uint32_t level(const Time &t)
{
    const double unit = 1073741824.0;
    auto bounds = Kernel().approximate_absolute_1_object()(t, 40);
    double middle = CGAL::to_double((bounds.first + bounds.second) / 2);
    // So near to t that the next multiple above lies above t.
    long k = (long)std::floor(middle * unit) + 1;
    while (t < Time(Rational(Integer(k), Integer(1) << 30)))
        k--;
    return (uint32_t)k;
}

Integer integer(double mantissa, int shift)
{
    return Integer((long)mantissa) << (unsigned long)shift;
}

void read(const double x0[4][3], const double x1[4][3], Vec p[4])
{
    int least = 0, e;
    bool first = true;
    for (int k = 0; k < 24; k++) {
        double x = (k < 12 ? x0 : x1)[k % 12 / 3][k % 3];
        if (std::frexp(x, &e) == 0)
            continue;
        least = first ? e - 53 : std::min(least, e - 53);
        first = false;
    }
    auto whole = [&](double x) {
        double f = std::frexp(x, &e);
        return f == 0 ? Integer(0) : integer(std::ldexp(f, 53), e - 53 - least);
    };
    for (int k = 0; k < 12; k++) {
        Integer a = whole(x0[k / 3][k % 3]), b = whole(x1[k / 3][k % 3]);
        p[k / 3].c[k % 3] = Poly(a, b - a);
    }
}

} // namespace

int orc_ccd_cgal(int kind, const double x0[4][3], const double x1[4][3],
                 uint32_t *toi)
{
    Vec p[4];
    read(x0, x1, p);
    *toi = ORC_NEVER;
    for (const Time &t : candidates(kind, p))
        if (kind == 0 ? vertex_face(p, t) : edge_edge(p, t)) {
            *toi = level(t);
            return 1;
        }
    return 0;
}
