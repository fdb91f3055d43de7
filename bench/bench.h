/* SPDX-License-Identifier: Apache-2.0 */
/* The parts of build/single measure single stages of the reference. Each writes
 * csv files; results that must hold are counted as checks. spec/accuracy.md §8
 */
#ifndef BENCH_BENCH_H
#define BENCH_BENCH_H

#include <stdbool.h>
#include <stdio.h>

struct bench {
    const char *directory; /* where the csv files go */
    bool quick;            /* run a small form, for make check */
    int passed, failed;
};

/* Opens DIRECTORY/name.csv and writes its first line. Ends the program if that
 * fails. */
FILE *bench_csv(const struct bench *b, const char *name, const char *header);
/* Counts a check, and prints it if it failed. */
#if defined(__GNUC__)
__attribute__((format(printf, 3, 4)))
#endif
void bench_check(struct bench *b, bool good, const char *format, ...);
/* Returns zeroed memory. Ends the program if there is none. */
void *bench_take(size_t count, size_t size);
/* Returns the processor time of the process, s. */
double bench_clock(void);

/* Writes impacts.csv: drape_ccd, FCL and bisection against exact rationals. */
void impact_times(struct bench *b);
/* Writes distances.csv: drape's distance and a textbook's in binary32, against
 * long double. */
void impact_distances(struct bench *b);

#endif
