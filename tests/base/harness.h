/* SPDX-License-Identifier: Apache-2.0 */
/* The test harness: what a stage X gives for differential checks, benchmarks,
 * golden hashes, replay, self-test and fuzzing, namely fields_X, gen_X and
 * prop_X. */
#ifndef TESTS_HARNESS_H
#define TESTS_HARNESS_H

#include <stddef.h>

#include "names/tests.h"
#include "ref/base/stage.h"

enum field_kind { FIELD_IN, FIELD_OUT, FIELD_INOUT, FIELD_SCRATCH };

/* A stream of a stage: the struct member at offset `at` is a pointer to `count`
 * items of `per` elements. Counts are int64_t members of the same struct, or
 * `fixed`. `used` is the int64_t member that says how many items were written,
 * for an output that may be shorter than its buffer. */
struct field {
    const char *name;
    enum field_kind kind;
    size_t at;
    size_t element; /* bytes of one element */
    int per;
    long count_at, used_at; /* offset, or -1 */
    int64_t fixed;
    bool reals; /* elements are reals: any two NaN are equal */
};

#define REALS_(lvalue) _Generic(lvalue, real : 1, vec : 1, sym : 1, default : 0)
#define FIELD_(k, X, m, per, count, used, fixed)                               \
    {                                                                          \
#m, k, offsetof(struct X, m), sizeof *((struct X *)0)->m, per, count,  \
            used, fixed, REALS_(*((struct X *)0)->m)                           \
    }
/* Input, output and scratch streams of s->n·per elements; n is named. gen_X
 * takes the inputs, the harness allocates outputs and scratch. */
#define IN(X, m, n, per)                                                       \
    FIELD_(FIELD_IN, X, m, per, (long)offsetof(struct X, n), -1, 0)
#define OUT(X, m, n, per)                                                      \
    FIELD_(FIELD_OUT, X, m, per, (long)offsetof(struct X, n), -1, 0)
#define SCRATCH(X, m, n, per)                                                  \
    FIELD_(FIELD_SCRATCH, X, m, per, (long)offsetof(struct X, n), -1, 0)
/* An output of which the stage writes only the first s->used items. */
#define OUT_USED(X, m, n, per, used)                                           \
    FIELD_(FIELD_OUT, X, m, per, (long)offsetof(struct X, n),                  \
           (long)offsetof(struct X, used), 0)
/* A fixed number of elements. */
#define IN_FIXED(X, m, k) FIELD_(FIELD_IN, X, m, 1, -1, -1, k)
#define OUT_FIXED(X, m, k) FIELD_(FIELD_OUT, X, m, 1, -1, -1, k)
/* A stream that the stage updates in place: gen_X allocates and fills the
 * stream; the harness restores it between runs and hashes it as an output. */
#define INOUT(X, m, n, per)                                                    \
    FIELD_(FIELD_INOUT, X, m, per, (long)offsetof(struct X, n), -1, 0)
/* An output scalar inside the struct itself: `per` bytes at the member. */
#define OUT_VALUE(X, m)                                                        \
    {                                                                          \
#m, FIELD_OUT, offsetof(struct X, m), 0, sizeof((struct X *)0)->m, -1, \
            -1, 0, REALS_(((struct X *)0)->m)                                  \
    }
#define FIELD_END                                                              \
    {                                                                          \
        NULL, FIELD_IN, 0, 0, 0, -1, -1, 0, 0                                  \
    }

struct bytes; /* a seeded generator, a fuzzer's bytes, or a file's */

/* Returns a choice in [0, n), n ≥ 1. */
uint32_t pick(struct bytes *b, uint32_t n);
/* The size that this case should have, in items. */
int64_t pick_size(struct bytes *b);
/* A real within ±scale, adversarial: on a coarse grid, ±0, subnormal, a
 * neighbour or repeat of the value before, a power of two, or plain uniform. */
real pick_real(struct bytes *b, real scale);
/* Uniform in [lo, hi]. */
real pick_uniform(struct bytes *b, real lo, real hi);
vec pick_vec(struct bytes *b, real scale);
/* The four vertices of a pair of primitives, chosen from n; some may
 * coincide. */
void pick_four(struct bytes *b, int64_t n, int32_t four[4]);
/* Returns zeroed memory for inputs, which the harness frees after the case. */
void *take(struct bytes *b, int64_t count, size_t size);
/* True if gen_X is to make the benchmark's input, which is large and
 * typical. */
bool for_bench(const struct bytes *b);

#define HARNESS_TEXT_(x) #x
#define HARNESS_TEXT(x) HARNESS_TEXT_(x)
/* For prop_X and tests: returns the condition as a text if it does not hold. */
#define EXPECT(condition)                                                      \
    do {                                                                       \
        if (!(condition))                                                      \
            return __FILE__ ":" HARNESS_TEXT(__LINE__) ": " #condition;        \
    } while (0)

/* Called by a test for the cases that it has run; a test without cases
 * fails. */
void ran(int64_t cases);
/* Marks the test as skipped, with a reason in one line. The test returns the
 * value. */
const char *skip(const char *why);
/* Extends a FNV-1a hash by some bytes; the first hash is HASH_START. */
#define HASH_START UINT64_C(14695981039346656037)
uint64_t hash_bytes(uint64_t hash, const void *data, size_t bytes);

struct gpu;

struct stage {
    const char *name;
    int bits;    /* of a real */
    size_t size; /* of struct X */
    int (*ref)(void *);
    int (*gpu)(struct gpu *, void *);
    const struct field *fields;
    void (*gen)(struct bytes *, void *);
    const char *(*prop)(const void *);
};

struct test {
    const char *name;
    const char *(*run)(void);
};

/* All generators, properties and tests are declared here, from the tables: a
 * function that is in no table does not compile. */
#define STAGE(room, file, X, rule)                                             \
    struct X;                                                                  \
    extern const struct field fields_##X[];                                    \
    void gen_##X(struct bytes *, struct X *);                                  \
    const char *prop_##X(const struct X *);
#include "spec/stages.def"
#undef STAGE
#define TEST(X) const char *test_##X(void);
#include "tests/tests.def"
#undef TEST

extern const struct stage stages_table[]; /* ends with a NULL name */
extern const struct test tests_table[];

#endif
