/* SPDX-License-Identifier: Apache-2.0 */
/* Isolates the real roots of polynomials of degree at most 3 with Sturm chains,
 * and finds the sign of another polynomial at a root, on the device.
 * spec/narrow/narrow.md §6.2, §6.4 */
#ifndef GPU_ROOTS_CUH
#define GPU_ROOTS_CUH

#include "gpu/narrow/point.cuh"

/* The Sturm chain of a polynomial p that has no repeated roots and no root at t
 * = 0 or t = 1, and its members rounded. */
struct chain {
    struct poly p, d, r; /* p, its derivative, the negated remainder */
    struct rough rough_p, rough_d, rough_r;
    int tail;  /* sign of the chain's last, constant member */
    int start; /* sign variations at t = 0 */
    int roots; /* roots in 0 < t < 1 */
};

/* Root i of a chain, counted 1, 2, … from t = 0; or a time on the grid. */
struct root {
    const struct chain *chain;
    int i;
    uint32_t cell; /* floor(2^30 t) */
    bool on_grid;  /* t = cell·2^-30 exactly */
};

/* Counts sign variations; zeros are skipped. */
static __device__ inline int variations(int a, int b, int c, int d)
{
    int sign[4] = {a, b, c, d}, last = 0, count = 0;
    for (int i = 0; i < 4; i++) {
        count += sign[i] * last < 0;
        last = sign[i] ? sign[i] : last;
    }
    return count;
}

/* Removes zero coefficients at both ends, which are roots at t = 0 and t =
 * 1. */
static __device__ inline struct poly poly_trimmed(const struct poly *p)
{
    struct poly r = {0, {{0, 0}, {0, 0}, {0, 0}, {0, 0}}};
    int lo = 0, hi = p->degree;
    while (hi > 0 && p->c[hi].n == 0)
        hi--;
    while (lo < hi && p->c[lo].n == 0)
        lo++;
    r.degree = hi - lo;
    for (int i = lo; i <= hi; i++)
        r.c[i - lo] = p->c[i];
    return r;
}

/* Sets a chain: p, its derivative, r, which is linear or absent, and the sign
 * of the last member. Counts its roots. */
static __device__ __noinline__ void chain_set(struct big_arena *m,
                                              const struct poly *p,
                                              const struct poly *r, int tail,
                                              struct chain *c)
{
    c->p = *p;
    c->r = *r;
    c->tail = tail;
    c->d.degree = p->degree - 1;
    for (int i = 1; i <= p->degree; i++)
        c->d.c[i - 1] = big_times(m, p->c[i], (uint32_t)i);
    int s = big_sign(p->c[p->degree]);
    int rest = big_sign(r->c[r->degree && r->c[1].n ? 1 : 0]);
    c->start = variations(big_sign(p->c[0]), big_sign(c->d.c[0]),
                          big_sign(r->c[0]), tail);
    c->roots = c->start - variations(s, s, rest, tail);
    c->rough_p = poly_rough(m, &c->p);
    c->rough_d = poly_rough(m, &c->d);
    c->rough_r = poly_rough(m, &c->r);
}

static __device__ inline struct poly poly_none(void)
{
    struct poly p = {0, {{0, 0}, {0, 0}, {0, 0}, {0, 0}}};
    return p;
}

/* Makes the chains of a cubic from its Hessian, whose discriminant is -3 times
 * the cubic's (§6.2). */
static __device__ inline int
chains_cubic(struct big_arena *m, const struct poly *p, struct chain c[2])
{
    struct big x = p->c[3], y = p->c[2], z = p->c[1], w = p->c[0], h[3];
    struct poly none = poly_none();
    h[2] = big_det(m, y, y, big_times(m, x, 3), z);
    h[1] = big_det(m, y, z, big_times(m, x, 9), w);
    h[0] = big_det(m, z, z, big_times(m, y, 3), w);
    int disc = big_sign(poly_discriminant(m, h)), s = big_sign(x);
    if (h[2].n == 0 && disc == 0) { /* a triple root */
        struct poly l = poly_linear(big_times(m, x, 3), y);
        chain_set(m, &l, &none, 0, &c[0]);
        return 1;
    }
    struct poly l = poly_linear(big_times(m, h[2], 2), h[1]);
    if (disc == 0) { /* a double and a simple root */
        struct poly k =
            poly_linear(big_mul(m, x, h[2]), big_det(m, y, h[2], x, h[1]));
        chain_set(m, &l, &none, 0, &c[0]);
        chain_set(m, &k, &none, 0, &c[1]);
        return 2;
    }
    if (s < 0)
        l = poly_linear(big_minus(l.c[1]), big_minus(l.c[0]));
    chain_set(m, p, &l, -disc * s, &c[0]);
    return 1;
}

/* Makes chains whose roots are together the distinct roots of p ≢ 0 in 0 < t <
 * 1. Returns the number of chains, at most 2. */
static __device__ __noinline__ int
chains_make(struct big_arena *m, const struct poly *p, struct chain c[2])
{
    struct poly f = poly_trimmed(p), none = poly_none();
    if (variations(big_sign(f.c[0]), big_sign(f.c[1]), big_sign(f.c[2]),
                   big_sign(f.c[3])) == 0) /* Descartes: no root in (0, 1) */
        return 0;
    if (f.degree == 3)
        return chains_cubic(m, &f, c);
    int tail = 0;
    if (f.degree == 2) {
        tail = big_sign(poly_discriminant(m, f.c)) * big_sign(f.c[2]);
        if (tail == 0)
            f = poly_linear(big_times(m, f.c[2], 2), f.c[1]);
    }
    chain_set(m, &f, &none, tail, &c[0]);
    return 1;
}

/* Returns how many roots of the chain lie in (0, τ], and sets *zero to whether
 * τ is one. τ is the point, or if that is NULL the time g on the grid. If the
 * chain has one root, the sign of p at τ suffices. */
static __device__ __noinline__ int roots_to(struct big_arena *m,
                                            const struct chain *c,
                                            const struct point *point,
                                            uint32_t g, bool *zero)
{
    int p = point ? point_sign(m, &c->p, point)
                  : sign_grid(m, &c->p, &c->rough_p, g);
    *zero = p == 0;
    if (c->roots == 1)
        return p != big_sign(c->p.c[0]);
    int d = point ? point_sign(m, &c->d, point)
                  : sign_grid(m, &c->d, &c->rough_d, g);
    int r = c->p.degree != 3 ? 0
            : point          ? point_sign(m, &c->r, point)
                             : sign_grid(m, &c->r, &c->rough_r, g);
    return c->start - variations(p, d, r, c->tail);
}

/* Locates root i of the chain, 1 ≤ i ≤ c->roots, to its cell. */
static __device__ inline void
root_locate(struct big_arena *m, const struct chain *c, int i, struct root *r)
{
    uint32_t lo = 0, hi = POINT_ONE; /* the root lies in (lo, hi] */
    r->chain = c;
    r->i = i;
    r->on_grid = false;
    while (hi - lo > 1) {
        uint32_t middle = lo + (hi - lo) / 2;
        bool zero;
        int count = roots_to(m, c, NULL, middle, &zero);
        if (count < i) {
            lo = middle;
            continue;
        }
        hi = middle;
        r->on_grid = zero && count == i;
    }
    r->cell = r->on_grid ? hi : lo;
}

/* §6.4: the sign of f, of degree at most 2, at a root. */

/* Joins three known signs: returns 2 where both signs occur, else the sign that
 * occurs. */
static __device__ inline int one_sign(int a, int b, int c)
{
    bool up = a > 0 || b > 0 || c > 0, down = a < 0 || b < 0 || c < 0;
    return up && down ? 2 : up ? 1 : -(int)down;
}

/* Returns the sign of the polar form of a quadratic at t and u; computes twice
 * the form, times 2^60. */
static __device__ inline int
polar_sign(struct big_arena *m, const struct poly *f, uint32_t t, uint32_t u)
{
    int mark = m->used;
    uint32_t s = POINT_ONE - t, v = POINT_ONE - u;
    struct big x =
        big_add(m, big_times(m, f->c[0], 2 * s), big_times(m, f->c[1], t));
    struct big y =
        big_add(m, big_times(m, f->c[1], s), big_times(m, f->c[2], 2 * t));
    int sign = big_sign(big_add(m, big_times(m, x, v), big_times(m, y, u)));
    m->used = mark;
    return sign;
}

/* As polar_sign, but from rounded coefficients where these are certain. */
static __device__ inline int polar_rough(struct big_arena *m,
                                         const struct poly *f,
                                         const struct rough *r, uint32_t g,
                                         uint32_t h)
{
    double t = g * 0x1p-30, u = h * 0x1p-30, s = 1 - t, v = 1 - u;
    double a = r->c[0] * (2 * s * v), b = r->c[1] * (t * v + s * u);
    double c = r->c[2] * (2 * t * u);
    int sign = rough_sign(a + b + c, fabs(a) + fabs(b) + fabs(c));
    return sign ? sign : polar_sign(m, f, g, h);
}

/* Returns the sign in the open cell if the Bernstein form there determines it,
 * else 2. */
static __device__ __noinline__ int sign_cell(struct big_arena *m,
                                             const struct poly *f, uint32_t g)
{
    struct rough r = poly_rough(m, f);
    if (f->degree < 2)
        return one_sign(0, sign_grid(m, f, &r, g), sign_grid(m, f, &r, g + 1));
    return one_sign(polar_rough(m, f, &r, g, g),
                    polar_rough(m, f, &r, g, g + 1),
                    polar_rough(m, f, &r, g + 1, g + 1));
}

/* Compares the point s with root r: 1 if s is before r, 0 if equal, -1 if
 * after. */
static __device__ inline int before(struct big_arena *m, const struct point *s,
                                    const struct root *r)
{
    bool zero;
    int count = roots_to(m, r->chain, s, 0, &zero);
    if (count < r->i)
        return 1;
    return zero && count == r->i ? 0 : -1;
}

/* Returns the sign of f at a root that is not on the grid, from the order of
 * f's own roots and that root. */
static __device__ __noinline__ int
sign_ordered(struct big_arena *m, const struct poly *f, const struct root *r)
{
    struct poly q = poly_trimmed(f);
    int sign = big_sign(q.c[0]), n = q.degree;
    int disc = n == 2 ? big_sign(poly_discriminant(m, q.c)) : 0;
    struct point s = {NULL, 0, {0, 0}, {0, 0}};
    if (n == 2 && disc > 0) {
        struct poly tau = poly_linear(big_small(m, 1), big_zero());
        s.q = &q;
        for (s.which = 0; s.which < 2; s.which++) {
            if (point_sign(m, &tau, &s) < 0)
                continue;
            int order = before(m, &s, r);
            if (order == 0)
                return 0;
            sign = order > 0 ? -sign : sign;
        }
        return sign;
    }
    if (n == 0 || disc < 0)
        return sign;
    /* one rational root -c0/c1, simple or double */
    struct poly l = n == 1 ? q : poly_linear(big_times(m, q.c[2], 2), q.c[1]);
    if (big_sign(l.c[0]) * big_sign(l.c[1]) >= 0)
        return sign;
    s.a = l.c[1].n > 0 ? big_minus(l.c[0]) : l.c[0];
    s.b = l.c[1].n > 0 ? l.c[1] : big_minus(l.c[1]);
    int order = before(m, &s, r);
    return order == 0 ? 0 : order > 0 && n == 1 ? -sign : sign;
}

static __device__ __noinline__ int
root_sign(struct big_arena *m, const struct poly *f, const struct root *r)
{
    if (poly_zero(f))
        return 0;
    int mark = m->used;
    int sign =
        r->on_grid ? sign_grid(m, f, NULL, r->cell) : sign_cell(m, f, r->cell);
    if (sign == 2)
        sign = sign_ordered(m, f, r);
    m->used = mark;
    return sign;
}

/* A sufficient test: true only where f, of degree at most 2, is not 0 at the
 * root. */
static __device__ inline bool
root_avoids(struct big_arena *m, const struct poly *f, const struct root *r)
{
    if (poly_zero(f))
        return false;
    int sign =
        r->on_grid ? sign_grid(m, f, NULL, r->cell) : sign_cell(m, f, r->cell);
    if (sign == 2)
        return r->chain->p.degree < 3 && poly_coprime(m, &r->chain->p, f);
    return sign != 0;
}

#endif
