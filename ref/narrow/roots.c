/* SPDX-License-Identifier: Apache-2.0 */
/* Isolates the real roots of polynomials of degree at most 3 with Sturm chains,
 * and finds the sign of another polynomial at a root, exactly.
 * spec/narrow/narrow.md §6.2, §6.4 */
#include "ref/narrow/roots.h"

#include <stddef.h>

/* Counts sign variations; zeros are skipped. */
static int count_sign_changes(const int *sign, int n)
{
    int last = 0, count = 0;
    for (int i = 0; i < n; i++) {
        count += sign[i] * last < 0;
        last = sign[i] ? sign[i] : last;
    }
    return count;
}

/* Removes zero coefficients at both ends, which are roots at t = 0 and t =
 * 1. */
static struct poly trim_polynomial(const struct poly *p)
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

static struct poly make_linear(struct big c1, struct big c0)
{
    struct poly p = {1, {c0, c1}};
    return p;
}

/* Writes the Hessian of a cubic. Its discriminant is -3 times the cubic's
 * (§6.2). */
static void write_hessian(struct big_arena *m, const struct big c[4],
                          struct big h[3])
{
    h[2] = big_det(m, c[2], c[2], big_times(m, c[3], 3), c[1]);
    h[1] = big_det(m, c[2], c[1], big_times(m, c[3], 9), c[0]);
    h[0] = big_det(m, c[1], c[1], big_times(m, c[2], 3), c[0]);
}

/* Sets c->start and c->roots from p, d, r and tail. */
static void count_roots(struct chain *c)
{
    int s = c->p.c[c->p.degree].sign;
    int first[4] = {c->p.c[0].sign, c->d.c[0].sign, c->r.c[0].sign, c->tail};
    int last[4] = {s, s, c->r.c[1].sign ? c->r.c[1].sign : c->r.c[0].sign,
                   c->tail};
    c->start = count_sign_changes(first, 4);
    c->roots = c->start - count_sign_changes(last, 4);
}

/* Sets c->p to p, which has no repeated roots, and c->d to its derivative. The
 * rest of the chain is zero. */
static void start_chain(struct big_arena *m, struct poly p, struct chain *c)
{
    struct chain none = {0};
    *c = none;
    c->p = p;
    c->d.degree = p.degree - 1;
    for (int i = 1; i <= p.degree; i++)
        c->d.c[i - 1] = big_times(m, p.c[i], (uint32_t)i);
}

/* Makes the chains of a cubic, §6.2. */
static int cubic_chains(struct big_arena *m, struct poly p, struct chain c[2])
{
    struct big h[3], a = p.c[3], b = p.c[2];
    write_hessian(m, p.c, h);
    int disc = poly_discriminant(m, h), s = a.sign;
    if (disc) {
        start_chain(m, p, &c[0]);
        c[0].tail = -disc * s;
        c[0].r = make_linear(big_times(m, h[2], 2), h[1]);
        if (s < 0)
            c[0].r = make_linear(big_negate(c[0].r.c[1]), big_negate(h[1]));
        count_roots(&c[0]);
        return 1;
    }
    if (h[2].sign == 0) { /* a triple root */
        start_chain(m, make_linear(big_times(m, a, 3), b), &c[0]);
        count_roots(&c[0]);
        return 1;
    }
    start_chain(m, make_linear(big_times(m, h[2], 2), h[1]), &c[0]);
    start_chain(m,
                make_linear(big_mul(m, a, h[2]), big_det(m, b, h[2], a, h[1])),
                &c[1]);
    count_roots(&c[0]);
    count_roots(&c[1]);
    return 2;
}

int chains_make(struct big_arena *m, const struct poly *p, struct chain c[2])
{
    int sign[4];
    struct poly f = trim_polynomial(p);
    for (int i = 0; i <= f.degree; i++)
        sign[i] = f.c[i].sign;
    if (count_sign_changes(sign, f.degree + 1) ==
        0) /* Descartes: no root in (0, 1) */
        return 0;
    if (f.degree == 3)
        return cubic_chains(m, f, c);
    int tail = 0;
    if (f.degree == 2) {
        tail = poly_discriminant(m, f.c) * f.c[2].sign;
        if (tail == 0)
            f = make_linear(big_times(m, f.c[2], 2), f.c[1]);
    }
    start_chain(m, f, &c[0]);
    c[0].tail = tail;
    count_roots(&c[0]);
    return 1;
}

/* The positions of the points of p, one or two, among the chain's roots, from
 * the signs of the chain's polynomials at them. */
static void find_stand(struct big_arena *m, const struct chain *c,
                       const struct point *p, struct stand s[2])
{
    int sign[4][2] = {{0}};
    point_sign(m, &c->p, p, sign[0]);
    if (c->roots > 1) { /* one root: the sign of p suffices */
        point_sign(m, &c->d, p, sign[1]);
        if (c->p.degree == 3)
            point_sign(m, &c->r, p, sign[2]);
    }
    for (int k = 0; k < (p->q ? 2 : 1); k++) {
        int at[4] = {sign[0][k], sign[1][k], sign[2][k], c->tail};
        s[k].zero = at[0] == 0;
        s[k].count = c->roots == 1 ? at[0] != c->p.c[0].sign
                                   : c->start - count_sign_changes(at, 4);
    }
}

static bool at_end(uint32_t cell)
{
    return cell == 0 || cell == ROOT_ONE - 1;
}

/* Returns the octave of root i in the first or last cell. All τ there are <
 * 2^-29 or > 2^29. */
static int octave_of(struct big_arena *m, const struct chain *c, int i,
                     uint32_t cell)
{
    int words = 0;
    for (int k = 0; k <= c->p.degree; k++)
        words = c->p.c[k].n > words ? c->p.c[k].n : words;
    int lo = cell ? 29 : -32 * words, hi = cell ? 32 * words : -29;
    while (hi - lo > 1) {
        int mark = m->used, mid = lo + (hi - lo) / 2;
        struct point p = point_power(m, mid);
        struct stand s[2];
        find_stand(m, c, &p, s);
        m->used = mark;
        if (s->count < i)
            lo = mid;
        else
            hi = mid;
    }
    return lo;
}

void root_locate(struct big_arena *m, struct chain *c, int i, struct root *r)
{
    uint32_t lo = 0, hi = ROOT_ONE; /* the root lies in (lo, hi] */
    r->chain = c;
    r->i = i;
    r->on_grid = false;
    while (hi - lo > 1) {
        int mark = m->used;
        struct stand s[2];
        uint32_t mid = lo + (hi - lo) / 2;
        struct point p = point_grid(m, mid);
        find_stand(m, c, &p, s);
        m->used = mark;
        if (s->count < i) {
            lo = mid;
            continue;
        }
        hi = mid;
        r->on_grid = s->zero && s->count == i;
    }
    r->cell = r->on_grid ? hi : lo;
    r->octave = !r->on_grid && at_end(lo) ? octave_of(m, c, i, lo) : 0;
}

/* Finds how the roots of f are ordered among the roots of the chain (§6.4). */
static void count_variations(struct big_arena *m, const struct poly *f,
                             const struct chain *c, struct variation_count *t)
{
    struct poly q = trim_polynomial(f);
    struct variation_count r = {.of = f, .sign = q.c[0].sign};
    struct point p = {&q, {0}, {0}, 0};
    int roots = q.degree == 2 ? poly_discriminant(m, q.c) : 0;
    *t = r;
    if (roots < 0)
        return;
    if (roots > 0) { /* two real roots; the coefficients' signs say how many
                        are positive */
        bool mixed = q.c[0].sign * q.c[2].sign < 0;
        t->n = mixed ? 1 : q.c[1].sign * q.c[2].sign < 0 ? 2 : 0;
        if (t->n)
            find_stand(m, c, &p, t->s);
        if (t->n == 1)
            t->s[0] = t->s[1];
        return;
    }
    /* one rational root -c0/c1, simple or double */
    t->twice = q.degree == 2;
    if (t->twice)
        q = make_linear(big_times(m, q.c[2], 2), q.c[1]);
    if (q.degree == 0 || q.c[0].sign * q.c[1].sign >= 0)
        return;
    bool up = q.c[1].sign > 0;
    p = (struct point){NULL, up ? big_negate(q.c[0]) : q.c[0],
                       up ? q.c[1] : big_negate(q.c[1]), 0};
    find_stand(m, c, &p, t->s);
    t->n = 1;
}

/* Returns the result of count_variations, which is kept for the chain's other
 * roots. */
static const struct variation_count *
count_of(struct big_arena *m, const struct poly *f, struct chain *c)
{
    int most = (int)(sizeof c->counts / sizeof *c->counts);
    for (int k = 0; k < c->seen; k++)
        if (c->counts[k].of == f)
            return &c->counts[k];
    struct variation_count *t =
        &c->counts[c->seen < most ? c->seen++ : most - 1];
    count_variations(m, f, c, t);
    return t;
}

/* Returns the sign of f at a root that is not on the grid: the sign at 0+,
 * flipped by each simple root of f below that root. */
static int sign_ordered(struct big_arena *m, const struct poly *f,
                        const struct root *r)
{
    const struct variation_count *t = count_of(m, f, r->chain);
    int sign = t->sign;
    for (int k = 0; k < t->n; k++) {
        int count = t->s[k].count;
        if (count == r->i && t->s[k].zero)
            return 0;
        if (count < r->i && !t->twice)
            sign = -sign;
    }
    return sign;
}

int root_quick(struct big_arena *m, const struct poly *f, const struct root *r)
{
    int sign[2] = {0, 0};
    if (f == r->of || poly_zero(f))
        return 0;
    if (!r->on_grid && at_end(r->cell))
        return poly_sign_octave(m, f, r->octave);
    if (!r->on_grid)
        return poly_sign_cell(m, f, r->cell);
    int mark = m->used;
    struct point p = point_grid(m, r->cell);
    point_sign(m, f, &p, sign);
    m->used = mark;
    return sign[0];
}

bool root_avoids(struct big_arena *m, const struct poly *f,
                 const struct root *r)
{
    int sign = root_quick(m, f, r);
    if (sign == ROOT_UNKNOWN)
        return r->chain->p.degree < 3 && poly_coprime(&r->chain->p, f);
    return sign != 0;
}

int root_sign(struct big_arena *m, const struct poly *f, const struct root *r)
{
    int mark = m->used, sign = root_quick(m, f, r);
    if (sign == ROOT_UNKNOWN)
        sign = sign_ordered(m, f, r);
    m->used = mark;
    return sign;
}
