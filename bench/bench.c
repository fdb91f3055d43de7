/* SPDX-License-Identifier: Apache-2.0 */
/* What the parts of build/single share: files, checks, memory and a clock. */
#include "bench/bench.h"

#include <stdarg.h>
#include <stdlib.h>
#include <time.h>

FILE *bench_csv(const struct bench *b, const char *name, const char *header)
{
    char path[4096];
    snprintf(path, sizeof path, "%s/%s.csv", b->directory, name);
    FILE *out = fopen(path, "w");
    if (!out) {
        fprintf(stderr, "single: %s: cannot be written\n", path);
        exit(2);
    }
    fprintf(out, "%s\n", header);
    return out;
}

void bench_check(struct bench *b, bool good, const char *format, ...)
{
    if (good) {
        b->passed++;
        return;
    }
    va_list arguments;
    va_start(arguments, format);
    printf("FAILED ");
    vprintf(format, arguments);
    printf("\n");
    fflush(stdout);
    va_end(arguments);
    b->failed++;
}

void *bench_take(size_t count, size_t size)
{
    void *p = calloc(count + 1, size);
    if (!p) {
        fputs("single: out of memory\n", stderr);
        exit(2);
    }
    return p;
}

double bench_clock(void)
{
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}
