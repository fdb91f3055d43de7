/* SPDX-License-Identifier: Apache-2.0 */
/* Signs of small polynomials at a point, exactly: spec/30_narrow.md §6.3. */
#include "ref/point.h"

#include <stddef.h>

bool poly_zero(const struct poly *p)
{
    for (int i = 0; i <= p->degree; i++)
        if (p->c[i].sign)
            return false;
    return true;
}

/* The sign of Σ c[i]·a^i·b^(n-i). */
static int sign_fraction(struct room *m, const struct poly *f, struct big a,
                         struct big b)
{
    int mark = m->used;
    struct big r = f->c[f->degree], power = b;
    for (int i = f->degree - 1; i >= 0; i--) {
        r = big_mul(m, r, a);
        if (f->c[i].sign)
            r = big_add(m, r, big_mul(m, f->c[i], power));
        if (i > 0)
            power = big_mul(m, power, b);
    }
    m->used = mark;
    return r.sign;
}

/* f modulo the quadratic q times a positive number: l[1]·τ + l[0]. */
static void reduce(struct room *m, const struct poly *f, const struct poly *q,
                   struct big l[2])
{
    struct big a = q->c[2], b = q->c[1], c = q->c[0], zero = {0};
    struct big f0 = f->c[0], f1 = f->degree > 0 ? f->c[1] : zero;
    struct big f2 = f->degree > 1 ? f->c[2] : zero;
    l[0] = f0;
    l[1] = f1;
    if (f->degree == 3 && f->c[3].sign) {
        struct big f3 = f->c[3];
        f2 = big_det(m, f2, a, f3, b);
        f1 = big_det(m, f1, a, f3, c);
        f0 = big_mul(m, f0, a);
        if (a.sign < 0) {
            f2 = big_negate(f2);
            f1 = big_negate(f1);
            f0 = big_negate(f0);
        }
        l[0] = f0;
        l[1] = f1;
    }
    if (f2.sign == 0)
        return;
    l[1] = big_det(m, f1, a, f2, b);
    l[0] = big_det(m, f0, a, f2, c);
    if (a.sign < 0) {
        l[1] = big_negate(l[1]);
        l[0] = big_negate(l[0]);
    }
}

/* The sign of f at a root of the quadratic q, which has two (§6.3). */
static int sign_surd(struct room *m, const struct poly *f, const struct poly *q,
                     int which)
{
    int mark = m->used;
    struct big l[2], a = q->c[2], b = q->c[1], c = q->c[0];
    reduce(m, f, q, l);
    int result = l[0].sign;
    if (l[1].sign) {
        /* u = -l0/l1 against the roots: z = sign q(u), w = sign q'(u) */
        struct big s = big_det(m, a, l[0], b, l[1]);
        struct big t = big_mul(m, c, l[1]);
        s = big_add(m, big_mul(m, s, l[0]), big_mul(m, t, l[1]));
        struct big d = big_sub(m, big_mul(m, b, l[1]),
                               big_times(m, big_mul(m, a, l[0]), 2));
        int z = s.sign * a.sign, w = d.sign * a.sign * l[1].sign;
        int past; /* sign of root - u */
        if (z < 0)
            past = which ? 1 : -1;
        else if (z == 0)
            past = w < 0 ? which : which - 1;
        else
            past = -w;
        result = past * l[1].sign;
    }
    m->used = mark;
    return result;
}

int point_sign(struct room *m, const struct poly *f, const struct point *p)
{
    return p->q ? sign_surd(m, f, p->q, p->which)
                : sign_fraction(m, f, p->a, p->b);
}

struct point point_grid(struct room *m, uint32_t g)
{
    struct point p = {NULL, 0, big_small(m, g), big_small(m, ROOT_ONE - g)};
    return p;
}

struct big poly_discriminant(struct room *m, const struct big c[3])
{
    return big_det(m, c[1], c[1], big_times(m, c[2], 4), c[0]);
}
