/* SPDX-License-Identifier: Apache-2.0 */
/* Measures single stages of the reference: products, solves, times of impact
 * and distances. With --quick it is a part of `make check`. `build/check-cuda
 * --bench-solve` measures solves on a device. spec/accuracy.md §8 */
#include "bench/bench.h"

#include <string.h>

int stages_products_32(FILE *out, int quick);
int stages_products_64(FILE *out, int quick);
int stages_solves_32(FILE *out, int quick);
int stages_solves_64(FILE *out, int quick);

static void solver(struct bench *b)
{
    FILE *out = bench_csv(b, "products",
                          "bits,side,form,ms,MB of matrix,cdf's time by this");
    int differ = stages_products_32(out, b->quick);
    differ += stages_products_64(out, b->quick);
    fclose(out);
    bench_check(b, !differ, "%d products differ between the forms", differ);
    out = bench_csv(b, "solves",
                    "bits,side,shape,precond,tolerance,iterations,reported,"
                    "true residual,end,ms");
    int missed = stages_solves_32(out, b->quick);
    missed += stages_solves_64(out, b->quick);
    fclose(out);
    bench_check(b, !missed, "%d true residuals miss the tolerance", missed);
}

int main(int argc, char **argv)
{
    struct bench b = {.quick = argc > 1 && !strcmp(argv[1], "--quick")};
    if (argc != 2 + b.quick) {
        fputs("usage: single [--quick] DIRECTORY\n", stderr);
        return 2;
    }
    b.directory = argv[1 + b.quick];
    solver(&b);
    impact_times(&b);
    impact_distances(&b);
    printf("%d passed, %d failed\n", b.passed, b.failed);
    return b.failed || !b.passed;
}
