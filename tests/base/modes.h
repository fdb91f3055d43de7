/* SPDX-License-Identifier: Apache-2.0 */
/* What the modes of check share. */
#ifndef TESTS_MODES_H
#define TESTS_MODES_H

#include "tests/base/case.h"

enum { SIZES = 11 };
extern const int64_t sizes[SIZES];
extern const int bits_of[2];

struct options {
    const char *only; /* one stage or test, or NULL */
    int cases;        /* of each size */
    uint64_t seed;
    int ranks;   /* of a team on the device, at most; 0: as many as it has */
    bool hosted; /* the host ends loops on the device */
    bool plain;  /* stages' properties are not looked at */
};
extern struct options options;
extern int passed, failed, skipped;

const struct stage *stages(int k); /* of 32 and 64 bits */
bool wanted(const char *name);
/* Case k of a size, the same on every run. */
struct bytes seeded(int64_t size, int k);
/* A failure is a file of choices: check --replay runs it again. */
void save_case(const char *stage, int bits, const struct bytes *b);
/* Counts, and prints what fails; what: NULL if nothing does. */
void report(const char *kind, const char *name, int bits, const char *what);
/* All cases of a stage; returns the hash of all their outputs. */
uint64_t run_stage(const struct stage *stage, int bits, bool quiet);

/* Loses the device in that stage of a world's steps, counted from 1 on, 0:
 * between two; NULL, or what does not hold from there on. tests/api/lost.c */
const char *lose_device_32(int stage);
const char *lose_device_64(int stage);

/* Modes on the device, tests/base/certify.c. */
void run_devices(void);
/* Emulated kernels without one of their barriers: some order of threads must
 * have other results, and each of both orders where the other has not. */
void self_test_races(void);
void bench_gpu(void);
/* Whole solves there, tests/solve/solve_gpu.c. */
void bench_solve_32(void);
void bench_solve_64(void);
/* Rows `stage bits cases mismatches digest` of every stage: generated cases
 * and, in 64 bits and 32, the files of corpus/STAGE. */
void certify(const char *corpus);

#endif
