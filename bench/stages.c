/* SPDX-License-Identifier: Apache-2.0 */
/* Measures single stages of the reference: products, solves, times of impact
 * and distances. `build/check-cuda --bench-solve` measures solves on a device.
 * spec/accuracy.md §8 */
#include "bench/accuracy.h"
#include "bench/impact.h"

int stages_products_32(FILE *out, int quick);
int stages_products_64(FILE *out, int quick);
int stages_solves_32(FILE *out, int quick);
int stages_solves_64(FILE *out, int quick);

void part_stages(struct bench *b)
{
    if (b->backend == DRAPE_GPU)
        return;
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
    impact_times(b);
    impact_distances(b);
}
