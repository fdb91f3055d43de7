/* SPDX-License-Identifier: Apache-2.0 */
/* Soaks the narrow phase: compares queries of every family with the oracles and
 * prints a table of the differences (`make soak`, bench/soak.md). */
#include "tests/narrow/soak.h"

#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include "oracle/oracle.h"
#include "ref/narrow/narrow.h"

enum {
    BLOCK = 64,          /* queries from one stream of choices */
    WILD_BLOCK = 8,      /* the same for the slow family */
    CGAL_EVERY = 1 << 10 /* every how many queries CGAL runs, which takes a
                            millisecond */
};

/* The families, in the order of enum query_family. `make soak` runs `blocks`
 * blocks of each kind and precision: more where a query takes a few
 * microseconds, fewer where a query needs all tiers and GMP. `make check` runs
 * one block. */
static const struct {
    const char *name;
    int blocks;
} families[QUERY_FAMILIES] = {
    {"small lattice", 8000},
    {"in an axis plane", 500},
    {"in an oblique plane", 500},
    {"on a line", 500},
    {"pure translation", 16000},
    {"no motion", 16000},
    {"collapsed", 500},
    {"contact at r/s", 500},
    {"contact at 0 or 1", 500},
    {"along an edge's line", 500},
    {"grazing", 500},
    {"double roots", 500},
    {"triple roots", 500},
    {"offset up to 2^20", 500},
    {"scaled by 2^-60 to 2^60", 500},
    {"nudged by an ulp", 500},
    {"millimetre cloth", 16000},
    {"smooth", 16000},
    {"of scenes, mutated", 500},
    {"any exponents", 50},
};

static double now(clockid_t clock)
{
    struct timespec t;
    clock_gettime(clock, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

uint32_t soak_decide(struct soak *s, const struct query *q)
{
    int tier;
    double start = now(CLOCK_MONOTONIC);
    uint32_t toi = query_tier(q, &tier);
    double seconds = now(CLOCK_MONOTONIC) - start;
    /* Takes the shortest of several runs, since an interruption also takes
     * time. */
    for (int k = 0; k < 5 && seconds > s->worst; k++) {
        start = now(CLOCK_THREAD_CPUTIME_ID);
        query_tier(q, &tier);
        double again = now(CLOCK_THREAD_CPUTIME_ID) - start;
        seconds = again < seconds ? again : seconds;
    }
    if (seconds > s->worst)
        s->worst = seconds;
    s->queries++;
    s->touching += toi != NARROW_MISS;
    s->tier[tier - 1]++;
    return toi;
}

void soak_add(struct soak *a, const struct soak *b)
{
    a->queries += b->queries;
    a->touching += b->touching;
    a->missed += b->missed;
    a->invented += b->invented;
    a->late += b->late;
    a->early += b->early;
    a->sampled += b->sampled;
    a->differ += b->differ;
    for (int k = 0; k < 3; k++)
        a->tier[k] += b->tier[k];
    a->worst = a->worst > b->worst ? a->worst : b->worst;
}

bool soak_clean(const struct soak *s)
{
    return !(s->missed || s->invented || s->late || s->early || s->differ);
}

void soak_head(void)
{
    puts("| family | queries | touch | missed | invented | late | early | "
         "tier 1 | tier 2 | tier 3 | worst µs | CGAL: queries | differ |\n"
         "| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | "
         "--- | --- |");
}

void soak_print(const char *name, const struct soak *s)
{
    const int64_t n[12] = {s->queries,  s->touching, s->missed,
                           s->invented, s->late,     s->early,
                           s->tier[0],  s->tier[1],  s->tier[2]};
    printf("| %s |", name);
    for (int k = 0; k < 9; k++)
        printf(" %lld |", (long long)n[k]);
    printf(" %.1f | %lld | %lld |\n", 1e6 * s->worst, (long long)s->sampled,
           (long long)s->differ);
    fflush(stdout);
}

static void print_query(const struct query *q)
{
    double x[2][4][3];
    query_double(q, x);
    printf("  kind %d:", q->kind);
    for (int i = 0; i < 24; i++)
        printf(" %a", x[i / 12][i / 3 % 4][i % 3]);
    puts("");
}

/* Counts late (the oracle's contact is before the answer's cell) and early (the
 * answer's cell has no contact). */
static void compare(struct soak *s, uint32_t toi, uint32_t truth)
{
    s->missed += toi == NARROW_MISS && truth != ORC_NEVER;
    s->invented += toi != NARROW_MISS && truth == ORC_NEVER;
    if (toi != NARROW_MISS && truth != ORC_NEVER) {
        s->late += toi > truth;
        s->early += toi < truth;
    }
}

static void ask(struct soak *s, const struct query *q, bool sample)
{
    double x[2][4][3];
    uint32_t toi = soak_decide(s, q), truth, again;
    query_double(q, x);
    const double(*x0)[3] = (const double(*)[3])x[0];
    const double(*x1)[3] = (const double(*)[3])x[1];
    orc_ccd_gmp(q->kind, x0, x1, &truth);
    compare(s, toi, truth);
    if (sample) {
        orc_ccd_cgal(q->kind, x0, x1, &again);
        s->sampled++;
        s->differ += again != truth;
    }
}

/* For the fuzzer: checks one query of any family, or of any 24 finite
 * numbers. */
const char *soak_query(struct bytes *b, int kind)
{
    struct soak s = {0};
    uint32_t family = pick(b, QUERY_FAMILIES + 1);
    struct query q = {.kind = kind};
    if (family < QUERY_FAMILIES)
        q = query_pick(b, kind, (int)family);
    for (int i = 0; i < 24 && family == QUERY_FAMILIES; i++) {
        uint64_t bits = (uint64_t)choose(b) << 32;
        bits |= choose(b);
        real a;
        if (sizeof a == 4)
            bits >>= 32;
        real_bits r = (real_bits)bits;
        memcpy(&a, &r, sizeof a);
        *query_at(&q, i) = a - a == 0 ? a : 0;
    }
    uint32_t toi = query_toi(&q);
    if (orc_present())
        ask(&s, &q, toi % 16 == 0);
    EXPECT(soak_clean(&s));
    return query_symmetry(&q, toi);
}

static struct soak ask_block(int family, int kind, int block)
{
    struct soak s = {0};
    uint64_t seed = ((uint64_t)family * 2 + (uint64_t)kind) * 100 + REAL_BITS;
    struct bytes b = {.seed = (seed << 32) + (uint64_t)block, .size = -1};
    bool clean = true;
    int n = family == QUERY_WILD ? WILD_BLOCK : BLOCK;
    for (int k = 0; k < n; k++) {
        struct query q = query_pick(&b, kind, family);
        ask(&s, &q, (n * block + k) % CGAL_EVERY == 0);
        if (clean && !soak_clean(&s))
            print_query(&q);
        clean = soak_clean(&s);
    }
    choices_free(&b);
    return s;
}

static struct soak ask_family(int family, int kind, int blocks)
{
    struct soak sum = {0};
#pragma omp parallel for schedule(dynamic)
    for (int k = 0; k < blocks; k++) {
        struct soak s = ask_block(family, kind, k);
#pragma omp critical
        soak_add(&sum, &s);
    }
    return sum;
}

static const char *ask_all(bool all)
{
    for (int kind = 0; kind < 2; kind++) {
        struct soak sum = {0};
        if (all) {
            printf("\n### %s, binary%d\n\n", kind ? "Edge-edge" : "Vertex-face",
                   REAL_BITS);
            soak_head();
        }
        for (int f = 0; f < QUERY_FAMILIES; f++) {
            struct soak s = ask_family(f, kind, all ? families[f].blocks : 1);
            if (all)
                soak_print(families[f].name, &s);
            soak_add(&sum, &s);
            EXPECT(soak_clean(&s));
        }
        if (all)
            soak_print("all", &sum);
        EXPECT(sum.touching > 0);
        ran(sum.queries);
    }
    return NULL;
}

/* narrow.md §1: queries of each family have the same contacts at the same times
 * as GMP's, a sample of them also as CGAL's. Where DRAPE_SOAK is set there are
 * 10^7 queries of each kind, half of them in binary32, and the real scenes are
 * all public queries. */
const char *test_narrow_soak(void)
{
    bool all = getenv("DRAPE_SOAK");
    int n = 0;
    if (!orc_present())
        return skip(NO_ORACLES);
    struct known *k = all ? query_load(&n) : NULL;
    struct query *q = n > 0 ? calloc((size_t)n, sizeof *q) : NULL;
    for (int i = 0; q && i < n; i++)
        q[i] = k[i].q;
    query_pool(q, q ? n : 0);
    const char *failed = ask_all(all);
    query_pool(NULL, 0);
    free(q);
    free(k);
    return failed;
}
