/* SPDX-License-Identifier: Apache-2.0 */
/* Real roots of small polynomials, exactly: spec/30_narrow.md §6.2 and §6.4. */
#include "ref/roots.h"

#include <stddef.h>

/* Sign variations, zeros skipped. */
static int variations(const int *sign, int n)
{
    int last = 0, count = 0;
    for (int i = 0; i < n; i++) {
        count += sign[i] * last < 0;
        last = sign[i] ? sign[i] : last;
    }
    return count;
}

/* Chops zero coefficients off both ends: roots at t = 0 and 1. */
static struct poly trimmed(const struct poly *p)
{
    struct poly r = {0};
    int lo = 0, hi = p->degree;
    while (hi > 0 && p->c[hi].sign == 0)
        hi--;
    while (lo < hi && p->c[lo].sign == 0)
        lo++;
    r.degree = hi - lo;
    for (int i = lo; i <= hi; i++)
        r.c[i - lo] = p->c[i];
    return r;
}

static struct poly linear(struct big c1, struct big c0)
{
    struct poly p = {1, {c0, c1}};
    return p;
}

/* The Hessian of a cubic; its discriminant is -3 times the cubic's. */
static void hessian(struct room *m, const struct big c[4], struct big h[3])
{
    h[2] = big_det(m, c[2], c[2], big_times(m, c[3], 3), c[1]);
    h[1] = big_det(m, c[2], c[1], big_times(m, c[3], 9), c[0]);
    h[0] = big_det(m, c[1], c[1], big_times(m, c[2], 3), c[0]);
}

/* Fills in the counts of a chain with p, d, r and tail set. */
static void count_roots(struct chain *c)
{
    int s = c->p.c[c->p.degree].sign;
    int first[4] = {c->p.c[0].sign, c->d.c[0].sign, c->r.c[0].sign, c->tail};
    int last[4] = {s, s, c->r.c[1].sign ? c->r.c[1].sign : c->r.c[0].sign,
                   c->tail};
    c->start = variations(first, 4);
    c->roots = c->start - variations(last, 4);
}

/* p without repeated roots and its derivative; the chain's end is zero. */
static void start_chain(struct room *m, struct poly p, struct chain *c)
{
    struct chain none = {0};
    *c = none;
    c->p = p;
    c->d.degree = p.degree - 1;
    for (int i = 1; i <= p.degree; i++)
        c->d.c[i - 1] = big_times(m, p.c[i], (uint32_t)i);
}

/* A cubic: §6.2. */
static int cubic_chains(struct room *m, struct poly p, struct chain c[2])
{
    struct big h[3], a = p.c[3], b = p.c[2];
    hessian(m, p.c, h);
    int disc = poly_discriminant(m, h), s = a.sign;
    if (disc) {
        start_chain(m, p, &c[0]);
        c[0].tail = -disc * s;
        c[0].r = linear(big_times(m, h[2], 2), h[1]);
        if (s < 0)
            c[0].r = linear(big_negate(c[0].r.c[1]), big_negate(h[1]));
        count_roots(&c[0]);
        return 1;
    }
    if (h[2].sign == 0) { /* a triple root */
        start_chain(m, linear(big_times(m, a, 3), b), &c[0]);
        count_roots(&c[0]);
        return 1;
    }
    start_chain(m, linear(big_times(m, h[2], 2), h[1]), &c[0]);
    start_chain(m, linear(big_mul(m, a, h[2]), big_det(m, b, h[2], a, h[1])),
                &c[1]);
    count_roots(&c[0]);
    count_roots(&c[1]);
    return 2;
}

int chains_make(struct room *m, const struct poly *p, struct chain c[2])
{
    int sign[4];
    struct poly f = trimmed(p);
    for (int i = 0; i <= f.degree; i++)
        sign[i] = f.c[i].sign;
    if (variations(sign, f.degree + 1) == 0) /* Descartes: none in (0, 1) */
        return 0;
    if (f.degree == 3)
        return cubic_chains(m, f, c);
    int tail = 0;
    if (f.degree == 2) {
        tail = poly_discriminant(m, f.c) * f.c[2].sign;
        if (tail == 0)
            f = linear(big_times(m, f.c[2], 2), f.c[1]);
    }
    start_chain(m, f, &c[0]);
    c[0].tail = tail;
    count_roots(&c[0]);
    return 1;
}

/* The variations of the chain at a point, and the sign of p there. */
static int chain_at(struct room *m, const struct chain *c,
                    const struct point *p, int *zero)
{
    int sign[4] = {point_sign(m, &c->p, p), point_sign(m, &c->d, p), 0,
                   c->tail};
    if (c->p.degree == 3)
        sign[2] = point_sign(m, &c->r, p);
    *zero = sign[0] == 0;
    return variations(sign, 4);
}

/* How many roots lie in (0, point]; whether the point is one. */
static int roots_to(struct room *m, const struct chain *c,
                    const struct point *p, int *zero)
{
    if (c->roots == 1) { /* the sign of p alone tells */
        int sign = point_sign(m, &c->p, p);
        *zero = sign == 0;
        return sign != c->p.c[0].sign;
    }
    return c->start - chain_at(m, c, p, zero);
}

void root_locate(struct room *m, const struct chain *c, int i, struct root *r)
{
    uint32_t lo = 0, hi = ROOT_ONE; /* the root lies in (lo, hi] */
    r->chain = c;
    r->i = i;
    r->on_grid = false;
    while (hi - lo > 1) {
        int mark = m->used, zero;
        uint32_t mid = lo + (hi - lo) / 2;
        struct point p = point_grid(m, mid);
        int count = roots_to(m, c, &p, &zero);
        m->used = mark;
        if (count < i) {
            lo = mid;
            continue;
        }
        hi = mid;
        r->on_grid = zero && count == i;
    }
    r->cell = r->on_grid ? hi : lo;
}

/* The sign of f inside the open cell where its Bernstein form on the cell
 * tells, else 2. */
static int sign_cell(struct room *m, const struct poly *f, uint32_t g)
{
    int mark = m->used, up = 0, down = 0, n = f->degree;
    uint32_t t[2] = {g, g + 1}, s[2] = {ROOT_ONE - g, ROOT_ONE - g - 1};
    for (int i = 0; i <= n; i++) {
        /* the polar form at n - i times g and i times g + 1 */
        uint32_t a = t[i > 0], b = s[i > 0], c = t[i == n], d = s[i == n];
        struct big r;
        if (n == 1)
            r = big_add(m, big_times(m, f->c[0], b), big_times(m, f->c[1], a));
        else {
            struct big x = big_add(m, big_times(m, f->c[0], 2 * b),
                                   big_times(m, f->c[1], a));
            struct big y = big_add(m, big_times(m, f->c[1], b),
                                   big_times(m, f->c[2], 2 * a));
            r = big_add(m, big_times(m, x, d), big_times(m, y, c));
        }
        up += r.sign > 0;
        down += r.sign < 0;
    }
    m->used = mark;
    return up && down ? 2 : up ? 1 : -(down > 0);
}

/* Where the point s stands to root r: 1 before, 0 at, -1 after it. */
static int before(struct room *m, const struct point *s, const struct root *r)
{
    int zero, count = roots_to(m, r->chain, s, &zero);
    if (count < r->i)
        return 1;
    return zero && count == r->i ? 0 : -1;
}

/* The sign of f at a root that is not on the grid, by where f's own roots
 * stand to it (§6.4). */
static int sign_ordered(struct room *m, const struct poly *f,
                        const struct root *r)
{
    struct poly q = trimmed(f);
    int sign = q.c[0].sign, n = q.degree;
    struct point s = {NULL, 0, {0}, {0}};
    if (n == 2 && poly_discriminant(m, q.c) > 0) {
        struct poly tau = linear(big_small(m, 1), (struct big){0});
        for (s.which = 0, s.q = &q; s.which < 2; s.which++) {
            if (point_sign(m, &tau, &s) < 0)
                continue;
            int order = before(m, &s, r);
            if (order == 0)
                return 0;
            sign = order > 0 ? -sign : sign;
        }
        return sign;
    }
    if (n == 0 || (n == 2 && poly_discriminant(m, q.c) < 0))
        return sign;
    /* one rational root -c0/c1, simple or double */
    struct poly l = n == 1 ? q : linear(big_times(m, q.c[2], 2), q.c[1]);
    if (l.c[0].sign * l.c[1].sign >= 0)
        return sign;
    s.a = l.c[1].sign > 0 ? big_negate(l.c[0]) : l.c[0];
    s.b = l.c[1].sign > 0 ? l.c[1] : big_negate(l.c[1]);
    int order = before(m, &s, r);
    return order == 0 ? 0 : order > 0 && n == 1 ? -sign : sign;
}

int root_sign(struct room *m, const struct poly *f, const struct root *r)
{
    if (poly_zero(f))
        return 0;
    int mark = m->used, sign;
    if (r->on_grid) {
        struct point p = point_grid(m, r->cell);
        sign = point_sign(m, f, &p);
    } else {
        sign = sign_cell(m, f, r->cell);
        if (sign == 2)
            sign = sign_ordered(m, f, r);
    }
    m->used = mark;
    return sign;
}
