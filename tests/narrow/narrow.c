/* SPDX-License-Identifier: Apache-2.0 */
/* The generator, the properties and the tests of stage narrow.
 * spec/narrow/narrow.md */
#include "ref/narrow/narrow.h"

#include "oracle/oracle.h"
#include "ref/narrow/exact.h"
#include "tests/narrow/query.h"

const struct field fields_narrow[] = {IN(narrow, pair, n, 4),
                                      IN(narrow, kind, n, 1),
                                      IN(narrow, x0, nv, 1),
                                      IN(narrow, x1, nv, 1),
                                      OUT(narrow, toi, n, 1),
                                      OUT(narrow, tier, n, 1),
                                      FIELD_END};

real *query_at(struct query *q, int i)
{
    vec *x = &q->x[i / 12][i / 3 % 4];
    return i % 3 == 0 ? &x->x : i % 3 == 1 ? &x->y : &x->z;
}

uint32_t query_tier(const struct query *q, int *tier)
{
    return q->kind ? narrow_ee(q->x[0], q->x[1], tier)
                   : narrow_vf(q->x[0], q->x[1], tier);
}

uint32_t query_toi(const struct query *q)
{
    int tier;
    return query_tier(q, &tier);
}

void query_double(const struct query *q, double x[2][4][3])
{
    struct query c = *q;
    for (int i = 0; i < 24; i++)
        x[i / 12][i / 3 % 4][i % 3] = (double)*query_at(&c, i);
}

/* Picks a query of any family, seldom of the slow family. */
static struct query pick_query(struct bytes *b)
{
    int kind = (int)pick(b, 2), family = (int)pick(b, QUERY_FAMILIES);
    if (family == QUERY_WILD && pick(b, 16))
        family = QUERY_LATTICE;
    return query_pick(b, kind, family);
}

void gen_narrow(struct bytes *b, struct narrow *s)
{
    s->n = for_bench(b) ? 1 << 18 : pick_size(b);
    s->nv = 4 * s->n;
    int32_t *pair = take(b, 4 * s->n, sizeof *pair);
    uint8_t *kind = take(b, s->n, 1);
    vec *x[2] = {take(b, s->nv, sizeof(vec)), take(b, s->nv, sizeof(vec))};
    for (int64_t i = 0; i < s->n; i++) {
        struct query q;
        if (for_bench(b))
            q = query_typical(b, (int)(i & 1));
        else
            q = pick_query(b);
        kind[i] = (uint8_t)q.kind;
        for (int j = 0; j < 4; j++) {
            pair[4 * i + j] = (int32_t)(4 * i + j);
            x[0][4 * i + j] = q.x[0][j];
            x[1][4 * i + j] = q.x[1][j];
        }
    }
    s->pair = pair;
    s->kind = kind;
    s->x0 = x[0];
    s->x1 = x[1];
}

/* Finds the middle of a motion. Returns false where a coordinate has no exact
 * middle. */
static bool middle(const struct query *q, vec half[4])
{
    struct query c = *q;
    for (int i = 0; i < 12; i++) {
        real a = *query_at(&c, i), d = *query_at(&c, i + 12);
        real s = a + d, v = s - a;
        real lost = (a - (s - v)) + (d - v), h = s * R(0.5);
        if (!(lost == 0 && h + h == s))
            return false;
        *query_at(&c, i) = h;
    }
    memcpy(half, c.x[0], sizeof c.x[0]);
    return true;
}

/* §7.1: the two halves of a motion give the answer of the whole motion. */
static const char *check_halves(const struct query *q, uint32_t toi)
{
    vec half[4];
    if (!middle(q, half))
        return NULL;
    struct query first = *q, second = *q;
    memcpy(first.x[1], half, sizeof half);
    memcpy(second.x[0], half, sizeof half);
    uint32_t a = query_toi(&first), b = query_toi(&second);
    if (a != NARROW_MISS)
        EXPECT(toi == a / 2);
    else if (b != NARROW_MISS)
        EXPECT(toi == (NARROW_ONE + b) / 2);
    else
        EXPECT(toi == NARROW_MISS);
    return NULL;
}

/* §7.2: the order of vertices, axes and primitives does not matter. */
const char *query_symmetry(const struct query *q, uint32_t toi)
{
    static const int order[2][3][4] = {
        {{0, 2, 3, 1}, {0, 2, 1, 3}, {0, 1, 3, 2}},
        {{2, 3, 0, 1}, {1, 0, 2, 3}, {0, 1, 3, 2}}};
    for (int k = 0; k < 3; k++) {
        struct query p = *q;
        for (int i = 0; i < 8; i++) {
            vec a = q->x[i / 4][order[q->kind][k][i % 4]];
            p.x[i / 4][i % 4] = vec_make(a.z, -a.x, a.y);
        }
        EXPECT(query_toi(&p) == toi);
    }
    return NULL;
}

/* §7.3: backwards in time the last contact comes first; primitives at rest in a
 * touching position touch. */
static const char *check_time(const struct query *q, uint32_t toi)
{
    struct query p = *q;
    memcpy(p.x[0], q->x[1], sizeof p.x[0]);
    memcpy(p.x[1], q->x[0], sizeof p.x[0]);
    uint32_t back = query_toi(&p);
    EXPECT((back == NARROW_MISS) == (toi == NARROW_MISS));
    EXPECT(back == NARROW_MISS || back <= NARROW_ONE - toi);
    p = *q;
    memcpy(p.x[1], q->x[0], sizeof p.x[0]);
    uint32_t start = query_toi(&p);
    EXPECT(start == 0 ? toi == 0 : start == NARROW_MISS);
    memcpy(p.x[0], q->x[1], sizeof p.x[0]);
    memcpy(p.x[1], q->x[1], sizeof p.x[0]);
    EXPECT(query_toi(&p) == NARROW_MISS ? toi != NARROW_ONE
                                        : toi <= NARROW_ONE);
    return NULL;
}

/* §7.4: scaling all positions by two does not matter. */
static const char *check_scale(const struct query *q, uint32_t toi)
{
    struct query p = *q;
    for (int i = 0; i < 24; i++) {
        real a = *query_at(&p, i);
        *query_at(&p, i) = a + a;
        if (!(a + a - a == a))
            return NULL;
    }
    EXPECT(query_toi(&p) == toi);
    return NULL;
}

/* §6: tier 3 alone and an oracle of another method agree. */
static const char *check_tiers(const struct query *q, uint32_t toi)
{
    static _Thread_local uint32_t word[EXACT_WORDS];
    double x[2][4][3];
    uint32_t exact;
    query_double(q, x);
    EXPECT(exact_first(x, q->kind, word, EXACT_WORDS, &exact) >= 0);
    EXPECT(exact == toi);
    return NULL;
}

static const char *check_oracle(const struct query *q, uint32_t toi)
{
    double x[2][4][3];
    uint32_t other;
    if (!orc_present())
        return NULL;
    query_double(q, x);
    int touch = orc_ccd_gmp(q->kind, (const double(*)[3])x[0],
                            (const double(*)[3])x[1], &other);
    EXPECT(touch == (toi != NARROW_MISS));
    EXPECT(!touch || other == toi);
    return NULL;
}

static struct query query_of(const struct narrow *s, int64_t i)
{
    struct query q = {.kind = s->kind[i]};
    for (int j = 0; j < 4; j++) {
        q.x[0][j] = s->x0[s->pair[4 * i + j]];
        q.x[1][j] = s->x1[s->pair[4 * i + j]];
    }
    return q;
}

const char *prop_narrow(const struct narrow *s)
{
    for (int64_t i = 0; i < s->n; i++) {
        struct query q = query_of(s, i);
        uint32_t toi = s->toi[i];
        EXPECT(toi <= NARROW_ONE || toi == NARROW_MISS);
        EXPECT(s->tier[i] >= 1 && s->tier[i] <= 3);
        const char *failed = check_tiers(&q, toi);
        failed = failed ? failed : check_halves(&q, toi);
        failed = failed ? failed : query_symmetry(&q, toi);
        failed = failed ? failed : check_time(&q, toi);
        failed = failed ? failed : check_scale(&q, toi);
        if (i % 8 == 0)
            failed = failed ? failed : check_oracle(&q, toi);
        if (failed)
            return failed;
    }
    return NULL;
}
