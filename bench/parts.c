/* SPDX-License-Identifier: Apache-2.0 */
/* The program of `make bench`: run time against error, stability, contact,
 * skipped work. With --quick it is a part of `make check`. spec/accuracy.md */
#include "bench/accuracy.h"

#include <string.h>

static void part_skip(struct bench *b)
{
    skip_table(b);
    skip_never(b);
    skip_sleep(b);
}

static const struct part {
    const char *name;
    void (*run)(struct bench *b);
} parts[] = {{"orders", part_orders}, {"work", part_work},
             {"newton", part_newton}, {"stability", part_stability},
             {"stress", part_stress}, {"contact", part_contact},
             {"drift", part_drift},   {"skip", part_skip},
             {"stages", part_stages}, {"backends", part_backends}};
enum { PARTS = sizeof parts / sizeof *parts };

static int usage(void)
{
    fputs("usage: accuracy [--quick] [--backend ref|gpu] DIRECTORY [PART...]\n"
          "Writes PART.csv: orders work newton stability stress contact drift "
          "skip\n"
          "stages backends (default: all).\n",
          stderr);
    return 2;
}

static void run_part(struct bench *b, const struct part *part)
{
    double start = bench_clock(b);
    part->run(b);
    fprintf(stderr, "%s: %.1f s\n", part->name, bench_clock(b) - start);
}

int main(int argc, char **argv)
{
    struct bench b = {.program = argv[0]};
    bool wanted[PARTS] = {0}, some = false, bare = false;
    for (int k = 1; k < argc; k++) {
        int part = 0;
        while (part < PARTS && strcmp(argv[k], parts[part].name) != 0)
            part++;
        if (!strcmp(argv[k], "--quick"))
            b.quick = true;
        else if (!strcmp(argv[k], "--bare"))
            bare = true;
        else if (!strcmp(argv[k], "--backend") && k + 1 < argc)
            b.backend = !strcmp(argv[++k], "gpu") ? DRAPE_GPU : DRAPE_REF;
        else if (!b.directory && argv[k][0] != '-')
            b.directory = argv[k];
        else if (part < PARTS)
            some = wanted[part] = true;
        else
            return usage();
    }
    if (bare) {
        part_bare(&b);
        return 0;
    }
    if (!b.directory)
        return usage();
    for (int k = 0; k < PARTS; k++)
        if (wanted[k] || !some)
            run_part(&b, &parts[k]);
    printf("%d passed, %d failed\n", b.passed, b.failed);
    return b.failed || !b.passed;
}
