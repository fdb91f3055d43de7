/* SPDX-License-Identifier: Apache-2.0 */
/* Signs of small polynomials at a point, exactly: spec/30_narrow.md §6.3. */
#include "ref/point.h"

#include "ref/near.h"

#include <stddef.h>

bool poly_zero(const struct poly *p)
{
    for (int i = 0; i <= p->degree; i++)
        if (p->c[i].sign)
            return false;
    return true;
}

/* ---- With as many words as m->keep says ---- */

/* The sign of Σ c[i]·a^i·b^(n-i). */
static int sign_fraction(struct room *m, const struct poly *f, struct big a0,
                         struct big b0)
{
    struct near a = near_of(m, a0), b = near_of(m, b0), power = b;
    struct near r = near_of(m, f->c[f->degree]);
    for (int i = f->degree - 1; i >= 0; i--) {
        r = near_mul(m, r, a);
        if (f->c[i].sign)
            r = near_add(m, r, near_mul(m, near_of(m, f->c[i]), power));
        if (i > 0)
            power = near_mul(m, power, b);
    }
    return near_sign(r);
}

/* a·b - c·d, times a sign. */
static struct near det(struct room *m, int sign, const struct near v[4])
{
    int mark = m->used;
    struct near x = near_mul(m, v[0], v[1]), y = near_mul(m, v[2], v[3]);
    struct near r = sign < 0 ? near_sub(m, y, x) : near_sub(m, x, y);
    r.m = big_keep(m, mark, r.m);
    return r;
}

/* f modulo the quadratic a τ² + b τ + c times a positive number:
 * l[1]·τ + l[0]. */
static void reduce(struct room *m, const struct poly *f, const struct near q[3],
                   struct near l[2])
{
    struct near c = q[0], b = q[1], a = q[2], g[4];
    int s = a.m.sign;
    for (int i = 0; i < 4; i++) {
        struct big zero = {0};
        g[i] = near_of(m, i <= f->degree ? f->c[i] : zero);
    }
    if (f->degree == 3 && f->c[3].sign) {
        g[2] = det(m, s, (struct near[4]){g[2], a, g[3], b});
        g[1] = det(m, s, (struct near[4]){g[1], a, g[3], c});
        g[0] = near_mul(m, g[0], a);
        g[0] = s < 0 ? near_negate(g[0]) : g[0];
    }
    l[0] = g[0];
    l[1] = g[1];
    if (near_sign(g[2]) == 0)
        return;
    l[1] = det(m, s, (struct near[4]){g[1], a, g[2], b});
    l[0] = det(m, s, (struct near[4]){g[0], a, g[2], c});
}

/* The sign of f at a root of the quadratic, which has two (§6.3). */
static int sign_surd(struct room *m, const struct poly *f,
                     const struct poly *of, int which)
{
    struct near l[2], q[3];
    for (int i = 0; i < 3; i++)
        q[i] = near_of(m, of->c[i]);
    reduce(m, f, q, l);
    int sign = near_sign(l[1]), lead = of->c[2].sign;
    if (sign == 0 || sign == NEAR_UNKNOWN)
        return sign ? sign : near_sign(l[0]);
    /* u = -l0/l1 against the roots: z = sign q(u), w = sign q'(u) */
    struct near s = det(m, 1, (struct near[4]){q[2], l[0], q[1], l[1]});
    struct near t = near_mul(m, q[0], l[1]);
    s = near_add(m, near_mul(m, s, l[0]), near_mul(m, t, l[1]));
    struct near two = near_times(m, near_mul(m, q[2], l[0]), 2);
    struct near d = near_sub(m, near_mul(m, q[1], l[1]), two);
    int z = near_sign(s), w = near_sign(d), past; /* sign of root - u */
    if (z == NEAR_UNKNOWN || w == NEAR_UNKNOWN)
        return NEAR_UNKNOWN;
    z *= lead;
    w *= lead * sign;
    if (z < 0)
        past = which ? 1 : -1;
    else if (z == 0)
        past = w < 0 ? which : which - 1;
    else
        past = -w;
    return past * sign;
}

/* ---- Few words first, then four times as many till these tell ---- */

int point_sign(struct room *m, const struct poly *f, const struct point *p)
{
    int mark = m->used, sign = NEAR_UNKNOWN;
    for (m->keep = NEAR_FEW; sign == NEAR_UNKNOWN; m->keep *= 4) {
        sign = p->q ? sign_surd(m, f, p->q, p->which)
                    : sign_fraction(m, f, p->a, p->b);
        m->used = mark;
    }
    return sign;
}

int poly_discriminant(struct room *m, const struct big c[3])
{
    int mark = m->used, sign = NEAR_UNKNOWN;
    for (m->keep = NEAR_FEW; sign == NEAR_UNKNOWN; m->keep *= 4) {
        struct near a = near_times(m, near_of(m, c[2]), 4);
        struct near b = near_of(m, c[1]), d = near_of(m, c[0]);
        sign = near_sign(det(m, 1, (struct near[4]){b, b, a, d}));
        m->used = mark;
    }
    return sign;
}

struct point point_grid(struct room *m, uint32_t g)
{
    struct point p = {NULL, 0, big_small(m, g), big_small(m, ROOT_ONE - g)};
    return p;
}
