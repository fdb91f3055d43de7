/* SPDX-License-Identifier: Apache-2.0 */
/* Tests truncated big integers: a sign that is reported as known is right.
 * spec/narrow/narrow.md §6.6 */
#include "ref/narrow/approx.h"

#include "ref/narrow/point.h"

#include "tests/base/choices.h"

/* Picks a number of up to 12 words, some of them 0 or all ones. */
static struct big pick_big(struct bytes *b, struct big_arena *m)
{
    struct big r = big_small(m, pick(b, 5));
    for (int k = (int)pick(b, 12); k > 0; k--) {
        uint32_t low = pick(b, 3) ? choose(b) : pick(b, 2) ? 0 : UINT32_MAX;
        r = big_add(m, big_shift(m, r, 1), big_small(m, low));
    }
    return pick(b, 2) ? r : big_negate(r);
}

/* Returns ((a·b - c·d)·b + d)·a, computed with m->keep words. */
static struct approx value_of(struct big_arena *m, const struct big v[4])
{
    struct approx a = approx_of(m, v[0]), b = approx_of(m, v[1]);
    struct approx c = approx_of(m, v[2]), d = approx_of(m, v[3]);
    struct approx r = approx_sub(m, approx_mul(m, a, b), approx_mul(m, c, d));
    r = approx_add(m, approx_mul(m, r, b), d);
    return approx_mul(m, r, a);
}

/* With one word kept or more, the sign is the exact sign or unknown. Unknown
 * occurs where the terms nearly cancel, but most signs are known. */
const char *test_near_signs(void)
{
    static uint32_t word[8192];
    struct bytes b = {.seed = 66, .size = -1};
    int told = 0, untold = 0;
    const char *failed = NULL;
    for (int k = 0; k < 20000 && !failed; k++) {
        struct big_arena m = {.word = word, .size = 8192, .keep = 8192};
        struct big v[4];
        for (int i = 0; i < 4; i++)
            v[i] = pick_big(&b, &m);
        if (k % 2) { /* c·d is near a·b, or equal to it */
            v[2] = v[1];
            v[3] = pick(&b, 3) ? big_add(&m, v[0], big_small(&m, 1)) : v[0];
        }
        struct approx whole = value_of(&m, v);
        int exact = approx_sign(whole);
        if (whole.rest != approx_rest(whole.m))
            failed = "a rest is wrong";
        for (m.keep = 1; m.keep < 8; m.keep++) {
            int sign = approx_sign(value_of(&m, v));
            if (exact == APPROX_UNKNOWN || m.full ||
                (sign != exact && sign != APPROX_UNKNOWN))
                failed = "a sign is wrong";
            told += sign != APPROX_UNKNOWN;
            untold += sign == APPROX_UNKNOWN;
        }
    }
    choices_free(&b);
    EXPECT(!failed);
    EXPECT(3 * told > untold && untold > 0);
    ran(told);
    return NULL;
}

/* Returns (a + b τ)(c + d τ). */
static struct poly product_of(struct big_arena *m, const struct big v[4])
{
    struct poly p = {2, {big_mul(m, v[0], v[2]), {0}, big_mul(m, v[1], v[3])}};
    p.c[1] = big_add(m, big_mul(m, v[0], v[3]), big_mul(m, v[1], v[2]));
    return p;
}

/* Polynomials with a common root are never reported coprime; most polynomials
 * without a common root are. */
const char *test_near_coprime(void)
{
    static uint32_t word[8192];
    struct bytes b = {.seed = 67, .size = -1};
    int told = 0;
    const char *failed = NULL;
    for (int k = 0; k < 5000 && !failed; k++) {
        struct big_arena m = {.word = word, .size = 8192, .keep = 8192};
        struct big v[4], w[4];
        for (int i = 0; i < 4; i++) {
            v[i] = pick_big(&b, &m);
            w[i] = i < 2 && k % 2 ? v[i] : pick_big(&b, &m);
        }
        struct poly p = product_of(&m, v), q = product_of(&m, w);
        struct poly l = {1, {v[0], v[1]}};
        if (k % 2 && (poly_coprime(&p, &q) || poly_coprime(&l, &q)))
            failed = "a common root is denied";
        told += k % 2 == 0 && poly_coprime(&p, &q);
    }
    choices_free(&b);
    EXPECT(!failed);
    EXPECT(told > 1500);
    ran(told);
    return NULL;
}
