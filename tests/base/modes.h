/* SPDX-License-Identifier: Apache-2.0 */
/* Options and functions that the modes of check share. */
#ifndef TESTS_MODES_H
#define TESTS_MODES_H

#include "tests/base/case.h"

enum { SIZES = 11 };
extern const int64_t sizes[SIZES];
extern const int bits_of[2];

struct options {
    const char *only; /* one stage or test, or NULL */
    int cases;        /* for each size */
    int bits;         /* 32 or 64: tests of this precision alone; 0: of both */
    uint64_t seed;
    int ranks;   /* blocks of a cluster on the device, at most; 0: its limit */
    bool hosted; /* loops on the device are ended by the host */
    bool plain;  /* properties of stages are not checked */
};
extern struct options options;
extern int passed, failed, skipped;

const struct stage *stages(int k); /* k = 0: 32 bits, 1: 64 bits */
bool wanted(const char *name);
/* Case k of a size, the same on every run. */
struct bytes seeded(int64_t size, int k);
/* Saves a failed case as a file of choices, which check --replay runs again. */
void save_case(const char *stage, int bits, const struct bytes *b);
/* Counts a result and prints a failure. what: the failure, or NULL. */
void report(const char *kind, const char *name, int bits, const char *what);
/* Runs all cases of a stage and returns the hash of all their outputs. */
uint64_t run_stage(const struct stage *stage, int bits, bool quiet);

/* Simulates the loss of the device in the given stage, counted from 1, of a
 * world's steps; 0: between two steps. Returns NULL, or what does not hold
 * afterwards. tests/api/lost.c */
const char *lose_device_32(int stage);
const char *lose_device_64(int stage);

/* Modes on the device, tests/base/certify.c. */
void run_devices(void);
/* Runs emulated kernels with a barrier left out: some order of threads must
 * give other results, and each of the two orders must find a race that the
 * other misses. */
void self_test_races(void);
void bench_gpu(void);
/* Times whole solves on the device, tests/solve/solve_gpu.c. */
void bench_solve_32(void);
void bench_solve_64(void);
/* Prints a row `stage bits cases mismatches digest` for every stage, from
 * generated cases and from the files of corpus/STAGE, in binary32 and
 * binary64. */
void certify(const char *corpus);

#endif
