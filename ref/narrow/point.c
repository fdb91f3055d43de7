/* SPDX-License-Identifier: Apache-2.0 */
/* Exact signs of polynomials of degree at most 3 at a rational point, or at the
 * roots of a quadratic. spec/narrow/narrow.md §6.3 */
#include "ref/narrow/point.h"

#include "ref/narrow/approx.h"

#include <stddef.h>

bool poly_zero(const struct poly *p)
{
    for (int i = 0; i <= p->degree; i++)
        if (p->c[i].sign)
            return false;
    return true;
}

/* Returns a·d - b·c modulo APPROX_PRIME. */
static uint64_t det_rest(uint64_t a, uint64_t b, uint64_t c, uint64_t d)
{
    return (a * d % APPROX_PRIME + APPROX_PRIME - b * c % APPROX_PRIME) %
           APPROX_PRIME;
}

bool poly_coprime(const struct poly *p, const struct poly *f)
{
    uint32_t a[3] = {0}, b[3] = {0};
    for (int i = 0; i <= p->degree; i++)
        a[i] = approx_rest(p->c[i]);
    for (int i = 0; i <= f->degree; i++)
        b[i] = approx_rest(f->c[i]);
    uint64_t x = det_rest(a[2], b[2], a[0], b[0]);
    uint64_t y = det_rest(a[2], b[2], a[1], b[1]);
    return det_rest(x, y, det_rest(a[1], b[1], a[0], b[0]), x) != 0;
}

/* Returns the sign of Σ c[i]·a^i·b^(n-i), where the factor 2^(32 k) of the
 * point is part of a. Computes with m->keep words. */
static int sign_fraction(struct big_arena *m, const struct poly *f,
                         const struct point *p)
{
    struct approx a = approx_of(m, p->a), b = approx_of(m, p->b), power = b;
    a.low += p->k;
    struct approx r = approx_of(m, f->c[f->degree]);
    for (int i = f->degree - 1; i >= 0; i--) {
        r = approx_mul(m, r, a);
        if (f->c[i].sign)
            r = approx_add(m, r, approx_mul(m, approx_of(m, f->c[i]), power));
        if (i > 0)
            power = approx_mul(m, power, b);
    }
    return approx_decide(m, r);
}

/* Returns sign · (v0·v1 - v2·v3), computed with m->keep words. */
static struct approx signed_determinant(struct big_arena *m, int sign,
                                        const struct approx v[4])
{
    int mark = m->used;
    struct approx x = approx_mul(m, v[0], v[1]), y = approx_mul(m, v[2], v[3]);
    struct approx r = sign < 0 ? approx_sub(m, y, x) : approx_sub(m, x, y);
    r.m = big_keep(m, mark, r.m);
    return r;
}

/* Writes g, of degree at most 2: a positive multiple of f modulo the quadratic
 * a τ² + b τ + c. */
static void lower_degree(struct big_arena *m, const struct poly *f,
                         const struct approx q[3], struct approx g[3])
{
    struct approx c = q[0], b = q[1], a = q[2];
    int s = a.m.sign;
    for (int i = 0; i < 3; i++) {
        struct big zero = {0};
        g[i] = approx_of(m, i <= f->degree ? f->c[i] : zero);
    }
    if (f->degree < 3 || f->c[3].sign == 0)
        return;
    struct approx lead = approx_of(m, f->c[3]);
    g[2] = signed_determinant(m, s, (struct approx[4]){g[2], a, lead, b});
    g[1] = signed_determinant(m, s, (struct approx[4]){g[1], a, lead, c});
    g[0] = approx_mul(m, g[0], a);
    g[0] = s < 0 ? approx_negate(g[0]) : g[0];
}

/* Writes l[1]·τ + l[0], a positive multiple of g modulo the quadratic q.
 * Returns the sign of the resultant of the two, which is negative where
 * -l[0]/l[1] lies between the roots of q. */
static int reduce_to_linear(struct big_arena *m, const struct approx g[3],
                            const struct approx q[3], struct approx l[2])
{
    struct approx c = q[0], b = q[1], a = q[2], r;
    int s = a.m.sign;
    struct approx x =
        signed_determinant(m, 1, (struct approx[4]){b, g[0], c, g[1]});
    bool linear = approx_sign(g[2]) == 0;
    l[0] = g[0];
    l[1] = g[1];
    if (!linear) {
        l[1] = signed_determinant(m, s, (struct approx[4]){g[1], a, g[2], b});
        l[0] = signed_determinant(m, s, (struct approx[4]){g[0], a, g[2], c});
        x = s < 0 ? approx_negate(x) : x;
    }
    r = linear ? approx_mul(m, a, l[0]) : l[0];
    r = signed_determinant(m, linear ? s : 1,
                           (struct approx[4]){r, l[0], x, l[1]});
    return approx_decide(m, r);
}

/* Returns the sign of b l1 - 2 a l0 for the quadratic a τ² + b τ + c. */
static int slope_sign(struct big_arena *m, const struct approx q[3],
                      const struct approx l[2])
{
    struct approx b = approx_few(q[1]), a = approx_few(q[2]);
    struct approx two = approx_times(m, l[0], 2);
    int sign = approx_sign(signed_determinant(
        m, 1, (struct approx[4]){b, approx_few(l[1]), a, approx_few(two)}));
    if (sign != APPROX_UNKNOWN)
        return sign;
    return approx_decide(
        m, signed_determinant(m, 1, (struct approx[4]){q[1], l[1], q[2], two}));
}

/* Finds the signs of f at the two real roots of a quadratic (§6.3). */
static void sign_surd(struct big_arena *m, const struct poly *f,
                      const struct poly *of, int out[2])
{
    struct approx l[2], q[3], g[3];
    for (int i = 0; i < 3; i++)
        q[i] = approx_of(m, of->c[i]);
    lower_degree(m, f, q, g);
    int z = reduce_to_linear(m, g, q, l), sign = approx_decide(m, l[1]), w = 0;
    int lead = of->c[2].sign;
    out[0] = out[1] = sign ? sign : approx_sign(l[0]);
    if (sign == 0 || sign == APPROX_UNKNOWN)
        return;
    if (z == 0 || z == 1) /* the side of the roots' midpoint on which -l0/l1
                             lies */
        w = slope_sign(m, q, l);
    for (int which = 0; which < 2; which++) {
        int past; /* sign of (root + l0/l1) */
        if (z < 0)
            past = which ? 1 : -1;
        else if (z == 0)
            past = w * lead * sign < 0 ? which : which - 1;
        else
            past = -w * lead * sign;
        out[which] = past * sign;
    }
    if (z == APPROX_UNKNOWN || w == APPROX_UNKNOWN)
        out[0] = out[1] = APPROX_UNKNOWN;
}

void point_sign(struct big_arena *m, const struct poly *f,
                const struct point *p, int sign[2])
{
    int mark = m->used;
    m->keep = APPROX_FEW;
    do {
        if (p->q)
            sign_surd(m, f, p->q, sign);
        else
            sign[0] = sign[1] = sign_fraction(m, f, p);
        m->used = mark;
        m->keep *= 2;
    } while (sign[0] == APPROX_UNKNOWN);
}

int poly_discriminant(struct big_arena *m, const struct big c[3])
{
    int mark = m->used, sign = APPROX_UNKNOWN;
    for (m->keep = APPROX_FEW; sign == APPROX_UNKNOWN; m->keep *= 2) {
        struct approx a = approx_times(m, approx_of(m, c[2]), 4);
        struct approx b = approx_of(m, c[1]), d = approx_of(m, c[0]);
        sign = approx_decide(
            m, signed_determinant(m, 1, (struct approx[4]){b, b, a, d}));
        m->used = mark;
    }
    return sign;
}

int poly_sign_cell(struct big_arena *m, const struct poly *f, uint32_t g)
{
    int mark = m->used, up = 0, down = 0, n = f->degree;
    uint32_t t[2] = {g, g + 1}, s[2] = {ROOT_ONE - g, ROOT_ONE - g - 1};
    m->keep = APPROX_FEW;
    for (int i = 0; i <= n; i++) {
        /* the polar form at n - i times g and i times g + 1 */
        uint32_t a = t[i > 0], b = s[i > 0], c = t[i == n], d = s[i == n];
        struct approx f0 = approx_of(m, f->c[0]), f1 = approx_of(m, f->c[1]), r;
        if (n == 1) {
            r = approx_add(m, approx_times(m, f0, b), approx_times(m, f1, a));
        } else {
            struct approx f2 = approx_of(m, f->c[2]);
            struct approx x = approx_times(m, f0, 2 * b);
            struct approx y = approx_times(m, f1, b);
            x = approx_add(m, x, approx_times(m, f1, a));
            y = approx_add(m, y, approx_times(m, f2, 2 * a));
            r = approx_add(m, approx_times(m, x, d), approx_times(m, y, c));
        }
        up += approx_sign(r) > 0; /* APPROX_UNKNOWN counts as both signs */
        down += approx_sign(r) < 0 || approx_sign(r) == APPROX_UNKNOWN;
    }
    m->used = mark;
    return up && down ? 2 : up ? 1 : -(down > 0);
}

int poly_sign_octave(struct big_arena *m, const struct poly *f, int e)
{
    /* The polar forms at (1, 1), (1, 2) and (2, 2), the middle one doubled. A
     * linear f uses the first and the last. */
    static const uint32_t weight[3][3] = {{1, 1, 1}, {2, 3, 4}, {1, 2, 4}};
    int mark = m->used, n = f->degree, up = 0, down = 0;
    struct approx c[3] = {0};
    m->keep = APPROX_FEW;
    for (int i = 0; i <= n; i++) { /* scaled so that all powers are whole */
        int shift = e < 0 ? (i - n) * e : i * e;
        c[i] =
            approx_times(m, approx_of(m, f->c[i]), UINT32_C(1) << shift % 32);
        c[i].low += shift / 32;
    }
    for (int j = 0; j < 3; j += 3 - n) {
        struct approx sum = approx_times(m, c[0], weight[j][0]);
        for (int i = 1; i <= n; i++)
            sum = approx_add(m, sum, approx_times(m, c[i], weight[j][i]));
        up += approx_sign(sum) == 1;
        down += approx_sign(sum) == -1;
    }
    m->used = mark;
    return up == n + 1 ? 1 : down == n + 1 ? -1 : 2;
}

struct point point_power(struct big_arena *m, int e)
{
    int k = e < 0 ? -((31 - e) / 32) : e / 32;
    struct big a = big_small(m, UINT32_C(1) << (e - 32 * k));
    struct point p = {.a = a, .b = big_small(m, 1), .k = k};
    return p;
}

struct point point_grid(struct big_arena *m, uint32_t g)
{
    struct big a = big_small(m, g);
    struct point p = {.a = a, .b = big_small(m, ROOT_ONE - g)};
    return p;
}
