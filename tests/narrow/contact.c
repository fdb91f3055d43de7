/* SPDX-License-Identifier: Apache-2.0 */
/* Tests the narrow phase on contact times computed by hand, on public queries,
 * and with any exponents. spec/narrow/narrow.md */
#include "ref/narrow/narrow.h"

#include <stdlib.h>

#include "oracle/oracle.h"
#include "ref/narrow/exact.h"
#include "tests/base/data.h"
#include "tests/narrow/query.h"

static real power(int e)
{
    real r = 1;
    for (; e != 0; e += e < 0 ? 1 : -1)
        r *= e < 0 ? R(0.5) : R(2.0);
    return r;
}

/* A position that is not finite and a bad vertex number are refused (narrow.md,
 * Err). */
const char *test_narrow_status(void)
{
    vec x0[4] = {{0, 0, 0}}, x1[4] = {{0, 0, 0}};
    int32_t pair[4] = {0, 1, 2, 3};
    uint8_t kind = 0, tier;
    uint32_t toi;
    struct narrow s = {.n = 1,
                       .pair = pair,
                       .kind = &kind,
                       .x0 = x0,
                       .x1 = x1,
                       .nv = 4,
                       .toi = &toi,
                       .tier = &tier};
    EXPECT(ref_narrow(&s) == DRAPE_OK && toi == 0);
    real bad[3] = {HUGE_VAL, -HUGE_VAL, 0};
    bad[2] = bad[0] + bad[1];
    for (int i = 0; i < 6; i++) {
        vec *x = i < 3 ? &x0[3] : &x1[1];
        x->y = bad[i % 3];
        EXPECT(ref_narrow(&s) == DRAPE_EDATA);
        x->y = 0;
    }
    pair[2] = 4;
    EXPECT(ref_narrow(&s) == DRAPE_EDATA);
    pair[2] = -1;
    EXPECT(ref_narrow(&s) == DRAPE_EDATA);
    pair[2] = 2;
    kind = 2;
    EXPECT(ref_narrow(&s) == DRAPE_EDATA);
    ran(1);
    return NULL;
}

/* Contacts whose times are computed by hand, in units of 2^-30. */
const char *test_narrow_known(void)
{
    static const struct {
        int kind;
        signed char x[2][4][3];
        uint32_t toi;
    } known[] = {
        /* falls through the middle of the face at 1/2, 1/3, 1, 0 */
        {0,
         {{{1, 1, 1}, {0, 0, 0}, {4, 0, 0}, {0, 4, 0}},
          {{1, 1, -1}, {0, 0, 0}, {4, 0, 0}, {0, 4, 0}}},
         1u << 29},
        {0,
         {{{1, 1, 1}, {0, 0, 0}, {4, 0, 0}, {0, 4, 0}},
          {{1, 1, -2}, {0, 0, 0}, {4, 0, 0}, {0, 4, 0}}},
         357913941},
        {0,
         {{{1, 1, 1}, {0, 0, 0}, {4, 0, 0}, {0, 4, 0}},
          {{1, 1, 0}, {0, 0, 0}, {4, 0, 0}, {0, 4, 0}}},
         1u << 30},
        {0,
         {{{1, 1, 0}, {0, 0, 0}, {4, 0, 0}, {0, 4, 0}},
          {{1, 1, 1}, {0, 0, 0}, {4, 0, 0}, {0, 4, 0}}},
         0},
        /* on the corner at 1/3; one beside it */
        {0,
         {{{0, 0, 1}, {0, 0, 0}, {4, 0, 0}, {0, 4, 0}},
          {{0, 0, -2}, {0, 0, 0}, {4, 0, 0}, {0, 4, 0}}},
         357913941},
        {0,
         {{{-1, 0, 1}, {0, 0, 0}, {4, 0, 0}, {0, 4, 0}},
          {{-1, 0, -2}, {0, 0, 0}, {4, 0, 0}, {0, 4, 0}}},
         NARROW_MISS},
        /* in the plane: reaches the side x = 0 at 1/4 */
        {0,
         {{{-1, 1, 0}, {0, 0, 0}, {4, 0, 0}, {0, 4, 0}},
          {{3, 1, 0}, {0, 0, 0}, {4, 0, 0}, {0, 4, 0}}},
         1u << 28},
        /* a face that is a segment, then one that is a point */
        {0,
         {{{1, 2, 0}, {0, 0, 0}, {4, 0, 0}, {2, 0, 0}},
          {{1, -1, 0}, {0, 0, 0}, {4, 0, 0}, {2, 0, 0}}},
         715827882},
        {0,
         {{{1, 1, 1}, {0, 0, 0}, {0, 0, 0}, {0, 0, 0}},
          {{-1, -1, -1}, {0, 0, 0}, {0, 0, 0}, {0, 0, 0}}},
         1u << 29},
        /* edges that cross at 1/2, touch end to end, miss */
        {1,
         {{{-1, 0, 1}, {1, 0, 1}, {0, -1, 0}, {0, 1, 0}},
          {{-1, 0, -1}, {1, 0, -1}, {0, -1, 0}, {0, 1, 0}}},
         1u << 29},
        {1,
         {{{-1, 0, 1}, {0, 0, 1}, {0, 0, 0}, {0, 1, 0}},
          {{-1, 0, -1}, {0, 0, -1}, {0, 0, 0}, {0, 1, 0}}},
         1u << 29},
        {1,
         {{{-2, 0, 1}, {-1, 0, 1}, {0, 0, 0}, {0, 1, 0}},
          {{-2, 0, -1}, {-1, 0, -1}, {0, 0, 0}, {0, 1, 0}}},
         NARROW_MISS},
        /* on one line: at 1/3; parallel beside it: never */
        {1,
         {{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}},
          {{3, 0, 0}, {4, 0, 0}, {2, 0, 0}, {3, 0, 0}}},
         357913941},
        {1,
         {{{0, 1, 0}, {1, 1, 0}, {2, 0, 0}, {3, 0, 0}},
          {{3, 1, 0}, {4, 1, 0}, {2, 0, 0}, {3, 0, 0}}},
         NARROW_MISS},
        /* in the plane, where t² + 2t = 1 */
        {0,
         {{{0, 0, 0}, {-1, 0, 0}, {2, -1, 0}, {0, -9, 0}},
          {{0, 0, 0}, {-1, 1, 0}, {3, -1, 0}, {0, -9, 0}}},
         444758425},
    };
    int n = (int)(sizeof known / sizeof *known);
    for (int k = 0; k < n; k++) {
        struct query q = {.kind = known[k].kind};
        for (int i = 0; i < 24; i++)
            *query_at(&q, i) = known[k].x[i / 12][i / 3 % 4][i % 3];
        EXPECT(query_toi(&q) == known[k].toi);
    }
    ran(n);
    return NULL;
}

/* No contact of the public queries with exact truth is missed and none is
 * invented. */
const char *test_narrow_queries(void)
{
    int n;
    const char *failed = NULL;
    struct known *k = query_load(&n);
    if (!k)
        return n ? "a query file cannot be read"
                 : skip("no ccd/queries in DRAPE_DATA" FETCHED);
    for (int i = 0; i < n && !failed; i++)
        if (k[i].exact) {
            if ((query_toi(&k[i].q) != NARROW_MISS) != k[i].truth)
                failed = "a query of ccd/queries";
            ran(1);
        }
    free(k);
    return failed;
}

/* §6.5: the arena suffices for any exponents, and the order of vertices does
 * not matter there. */
const char *test_narrow_range(void)
{
    static uint32_t word[EXACT_WORDS];
    struct bytes b = {.seed = 30, .size = -1};
    int top = REAL_BITS == 32 ? 127 : 1023, low = REAL_BITS == 32 ? 149 : 1074;
    const char *failed = NULL;
    for (int k = 0; k < 100 && !failed; k++) {
        struct query q = {.kind = k & 1};
        double x[2][4][3];
        uint32_t toi;
        for (int i = 0; i < 24; i++) {
            int e = pick(&b, 2) ? top : (int)pick(&b, (uint32_t)(top + low));
            real a = power(e > top ? top - e : e);
            a *= pick(&b, 3) ? 1 : 1 + pick_uniform(&b, 0, 1);
            *query_at(&q, i) = pick(&b, 8) ? (pick(&b, 2) ? a : -a) : 0;
            if (!(real_abs(*query_at(&q, i)) <= power(top)))
                *query_at(&q, i) = power(top);
        }
        for (int j = 0; j < 4 && k % 3 == 0; j++)
            q.x[0][j].z = q.x[1][j].z = 0;
        query_double(&q, x);
        int words = exact_first(x, q.kind, word, EXACT_WORDS, &toi);
        if (words < 0 || 2 * words > EXACT_WORDS)
            failed = "a query needs more room than half of what is given";
        failed = failed ? failed : query_toi(&q) == toi ? NULL : "tiers differ";
        uint32_t other;
        if (exact_first(x, q.kind, word, EXACT_LEAST, &other) >= 0)
            failed = other == toi ? failed : "the room matters";
        failed = failed ? failed : query_symmetry(&q, toi);
        ran(1);
    }
    choices_free(&b);
    return failed;
}

/* Makes queries with coordinates of any size, some of them equal. The vertices
 * lie in a plane z = 0, x or y, or two vertices coincide. */
static struct query pick_flat(struct bytes *b, int kind)
{
    struct query q = {.kind = kind};
    int top = REAL_BITS == 32 ? 127 : 1023, low = REAL_BITS == 32 ? 149 : 1074;
    uint32_t plane = pick(b, 4), j = pick(b, 4), other = pick(b, 4);
    for (int i = 0; i < 24; i++) {
        int e = (int)pick(b, (uint32_t)(top + low)) - low;
        real a = power(e) * (1 + pick_uniform(b, 0, 1));
        if (i && pick(b, 3) == 0)
            a = *query_at(&q, (int)pick(b, (uint32_t)i));
        *query_at(&q, i) = pick(b, 2) ? a : -a;
    }
    for (int i = 0; i < 8; i++) {
        vec *x = &q.x[i / 4][i % 4];
        x->z = plane == 0 ? 0 : plane == 1 ? x->x : plane == 2 ? x->y : x->z;
        if (plane == 3 && i % 4 == (int)j)
            *x = q.x[i / 4][other];
    }
    return q;
}

/* §6.5: motion that stays in one plane, with any exponents, gives GMP's
 * answers. */
const char *test_narrow_flat(void)
{
    struct bytes b = {.seed = 65, .size = -1};
    const char *failed = NULL;
    int touching = 0, n = getenv("DRAPE_SOAK") ? 4000 : 80;
    if (!orc_present())
        return skip(NO_ORACLES);
    for (int k = 0; k < n && !failed; k++) {
        struct query q = pick_flat(&b, k & 1);
        double x[2][4][3];
        uint32_t toi = query_toi(&q), truth;
        query_double(&q, x);
        orc_ccd_gmp(q.kind, (const double(*)[3])x[0], (const double(*)[3])x[1],
                    &truth);
        if (toi == NARROW_MISS ? truth != ORC_NEVER : toi != truth)
            failed = "an answer is not the oracle's";
        failed = failed ? failed : query_symmetry(&q, toi);
        touching += toi != NARROW_MISS && toi != 0;
        ran(1);
    }
    choices_free(&b);
    EXPECT(!failed);
    EXPECT(touching > n / 20);
    return NULL;
}
