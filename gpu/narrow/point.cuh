/* SPDX-License-Identifier: Apache-2.0 */
/* Exact signs of polynomials of degree at most 3 at a rational point, or at a
 * root of a quadratic, on the device. On the grid of times a binary64 filter
 * comes first. spec/narrow/narrow.md §6.3 */
#ifndef GPU_POINT_CUH
#define GPU_POINT_CUH

#include "gpu/narrow/big.cuh"

enum { POINT_ONE = 1 << 30 }; /* number of cells of the grid */

/* The polynomial Σ c[i]·τ^i with τ = t/(1-t), which is the scaled Bernstein
 * form on t in [0, 1]. Leading coefficients may be zero: each of them is a root
 * at t = 1. */
struct poly {
    int degree; /* at most 3 */
    struct big c[4];
};

/* The same polynomial, scaled and rounded: each coefficient with an error of at
 * most 2^-50 of itself, or 2^-800. */
struct rough {
    double c[4];
};

/* A time τ > 0: a/b, or a root of a quadratic. */
struct point {
    const struct poly *q; /* NULL: τ = a/b, b > 0 */
    int which;            /* 0 the smaller, 1 the larger root of q */
    struct big a, b;
};

static __device__ inline bool poly_zero(const struct poly *p)
{
    for (int i = 0; i <= p->degree; i++)
        if (p->c[i].n)
            return false;
    return true;
}

static __device__ inline struct poly poly_linear(struct big c1, struct big c0)
{
    struct poly p = {1, {c0, c1}};
    return p;
}

/* Returns a·k, k < 2^32. */
static __device__ __noinline__ struct big big_times(struct big_arena *m,
                                                    struct big a, uint32_t k)
{
    int n = big_words(a), at = room_take(m, n + 1);
    uint64_t carry = 0;
    for (int i = 0; i < n; i++) {
        carry += (uint64_t)m->word[a.at + i] * k;
        m->word[at + i] = (uint32_t)carry;
        carry >>= 32;
    }
    m->word[at + n] = (uint32_t)carry;
    return big_trim(m, at, n + 1, a.n < 0);
}

/* Returns b² - 4ac for c + bτ + aτ². */
static __device__ inline struct big poly_discriminant(struct big_arena *m,
                                                      const struct big c[3])
{
    return big_det(m, c[1], c[1], big_times(m, c[2], 4), c[0]);
}

/* Residues modulo the prime 2^32 - 5. */

enum { PRIME_GAP = 5 };

static __device__ inline uint64_t big_rest(const struct big_arena *m,
                                           struct big a)
{
    uint64_t r = 0, prime = ((uint64_t)1 << 32) - PRIME_GAP;
    for (int i = big_words(a) - 1; i >= 0; i--) /* r stays below 2^36 */
        r = ((r >> 32) * PRIME_GAP + (uint32_t)r) * PRIME_GAP +
            m->word[a.at + i];
    r %= prime;
    return a.n < 0 && r ? prime - r : r;
}

/* Returns a·d - b·c modulo the prime. */
static __device__ inline uint64_t det_rest(uint64_t a, uint64_t b, uint64_t c,
                                           uint64_t d)
{
    uint64_t prime = ((uint64_t)1 << 32) - PRIME_GAP;
    return (a * d % prime + prime - b * c % prime) % prime;
}

/* A sufficient test: true only where p and f, of degree at most 2, have no
 * common root. Their resultant as quadratics is then nonzero modulo the
 * prime. */
static __device__ __noinline__ bool poly_coprime(const struct big_arena *m,
                                                 const struct poly *p,
                                                 const struct poly *f)
{
    uint64_t a[3] = {0, 0, 0}, b[3] = {0, 0, 0};
    for (int i = 0; i <= p->degree; i++)
        a[i] = big_rest(m, p->c[i]);
    for (int i = 0; i <= f->degree; i++)
        b[i] = big_rest(m, f->c[i]);
    uint64_t x = det_rest(a[2], b[2], a[0], b[0]);
    uint64_t y = det_rest(a[2], b[2], a[1], b[1]);
    return det_rest(x, y, det_rest(a[1], b[1], a[0], b[0]), x) != 0;
}

/* Returns a·2^(-32 top) from the three highest words of a; `top` must be at
 * least the number of its words. The words left out are below 2^-64 of a, and
 * two sums round. */
static __device__ inline double big_rough(const struct big_arena *m,
                                          struct big a, int top)
{
    int n = big_words(a), e = 32 * (n - 2 - top);
    if (n == 0 || e < -900)
        return 0;
    const uint32_t *d = m->word + a.at;
    double r = (double)d[n - 1] * 0x1p32;
    if (n > 1)
        r += (double)d[n - 2];
    if (n > 2)
        r += (double)d[n - 3] * 0x1p-32;
    uint64_t bits = (uint64_t)(1023 + e) << 52;
    double scale;
    memcpy(&scale, &bits, sizeof scale);
    return a.n < 0 ? -(r * scale) : r * scale;
}

static __device__ inline struct rough poly_rough(const struct big_arena *m,
                                                 const struct poly *p)
{
    struct rough r = {{0, 0, 0, 0}};
    int top = 0;
    for (int i = 0; i <= p->degree; i++)
        top = max_of(top, big_words(p->c[i]));
    for (int i = 0; i <= p->degree; i++)
        r.c[i] = big_rough(m, p->c[i], top);
    return r;
}

/* Bounds for the sign of a sum of terms whose magnitudes add to `size`. A term
 * is off by at most 2^-50 of itself and meets at most eight roundings: under
 * 2^-48; `size` is off by less than half. Both are proven in
 * spec/proofs/narrow_rough.gappa. */
#define ERROR_ROUGH 0x1p-46
#define UNDERFLOW_ROUGH 0x1p-700
static __device__ inline int rough_sign(double sum, double size)
{
    double bound = ERROR_ROUGH * size + UNDERFLOW_ROUGH;
    return sum > bound ? 1 : sum < -bound ? -1 : 0;
}

/* Returns the sign at t = g·2^-30, or 0 where the sign is not certain. */
static __device__ inline int rough_at(const struct rough *p, int degree,
                                      uint32_t g)
{
    double t = g * 0x1p-30, s = 1 - t, power = s;
    double sum = p->c[degree], size = fabs(sum);
    for (int i = degree - 1; i >= 0; i--) {
        sum = sum * t + p->c[i] * power;
        size = size * t + fabs(p->c[i]) * power;
        power *= s;
    }
    return rough_sign(sum, size);
}

/* Returns the sign of Σ c[i]·a^i·b^(n-i). */
static __device__ __noinline__ int sign_fraction(struct big_arena *m,
                                                 const struct poly *f,
                                                 struct big a, struct big b)
{
    int mark = m->used;
    struct big r = f->c[f->degree], power = b;
    for (int i = f->degree - 1; i >= 0; i--) {
        r = big_mul(m, r, a);
        if (f->c[i].n)
            r = big_add(m, r, big_mul(m, f->c[i], power));
        if (i > 0)
            power = big_mul(m, power, b);
    }
    m->used = mark;
    return big_sign(r);
}

/* Returns the exact sign at t = g·2^-30. `rough` is f rounded, or NULL. */
static __device__ inline int sign_grid(struct big_arena *m,
                                       const struct poly *f,
                                       const struct rough *rough, uint32_t g)
{
    if (g == 0)
        return big_sign(f->c[0]);
    if (g == POINT_ONE)
        return big_sign(f->c[f->degree]);
    int sign = rough ? rough_at(rough, f->degree, g) : 0;
    if (sign)
        return sign;
    int mark = m->used;
    struct big a = big_small(m, g), b = big_small(m, POINT_ONE - g);
    sign = sign_fraction(m, f, a, b);
    m->used = mark;
    return sign;
}

/* Writes l[1]·τ + l[0], a positive multiple of f modulo the quadratic q. */
static __device__ inline void reduce(struct big_arena *m, const struct poly *f,
                                     const struct poly *q, struct big l[2])
{
    struct big a = q->c[2], b = q->c[1], c = q->c[0];
    struct big f0 = f->c[0], f1 = f->degree > 0 ? f->c[1] : big_zero();
    struct big f2 = f->degree > 1 ? f->c[2] : big_zero();
    bool flip = false;
    if (f->degree == 3 && f->c[3].n) {
        struct big f3 = f->c[3];
        f2 = big_det(m, f2, a, f3, b);
        f1 = big_det(m, f1, a, f3, c);
        f0 = big_mul(m, f0, a);
        flip = a.n < 0;
    }
    if (f2.n) {
        l[1] = big_det(m, f1, a, f2, b);
        l[0] = big_det(m, f0, a, f2, c);
        flip = flip != (a.n < 0);
    } else {
        l[1] = f1;
        l[0] = f0;
    }
    if (flip) {
        l[1] = big_minus(l[1]);
        l[0] = big_minus(l[0]);
    }
}

/* Returns the sign of f at a root of the quadratic q, which has two real
 * roots. */
static __device__ __noinline__ int sign_surd(struct big_arena *m,
                                             const struct poly *f,
                                             const struct poly *q, int which)
{
    int mark = m->used, sa = big_sign(q->c[2]);
    struct big l[2], a = q->c[2], b = q->c[1], c = q->c[0];
    reduce(m, f, q, l);
    int result = big_sign(l[0]), s1 = big_sign(l[1]);
    if (s1) {
        /* where u = -l0/l1 lies among the roots: z = sign q(u), w = sign
         * q'(u) */
        struct big s = big_det(m, a, l[0], b, l[1]);
        s = big_add(m, big_mul(m, s, l[0]),
                    big_mul(m, big_mul(m, c, l[1]), l[1]));
        struct big d = big_sub(m, big_mul(m, b, l[1]),
                               big_times(m, big_mul(m, a, l[0]), 2));
        int z = big_sign(s) * sa, w = big_sign(d) * sa * s1, past;
        if (z < 0)
            past = which ? 1 : -1;
        else if (z == 0)
            past = w < 0 ? which : which - 1;
        else
            past = -w;
        result = past * s1;
    }
    m->used = mark;
    return result;
}

static __device__ inline int
point_sign(struct big_arena *m, const struct poly *f, const struct point *p)
{
    return p->q ? sign_surd(m, f, p->q, p->which)
                : sign_fraction(m, f, p->a, p->b);
}

#endif
