/* SPDX-License-Identifier: Apache-2.0 */
/* The price of exactness: kernels of gpu/ compiled as they are, and with flags
 * that let the compiler change the bits. spec/gpu.md §8 */
#ifndef BENCH_PRICE_H
#define BENCH_PRICE_H

#include "gpu/run/gpu.h"
#include "ref/base/sum.h"
#include "ref/cloth/springs.h"

#define price_run REAL_NAME(price_run)
#define price_exact REAL_NAME(price_exact)
#define price_fma REAL_NAME(price_fma)
#define price_fast REAL_NAME(price_fast)

#ifdef __cplusplus
extern "C" {
#endif

/* The kernels compiled with one set of flags. Their streams are in device
 * memory. */
struct price {
    const char *flags;
    void (*springs)(struct gpu *g, const struct springs *s);
    /* Writes the sum to the first bytes of word[0]; word[0 … 1] must be 0. */
    void (*dot)(struct gpu *g, const struct dot *s, int64_t *word);
    /* Computes the sum in no fixed order, by atomic additions. */
    void (*loose)(struct gpu *g, const struct dot *s, int64_t *word);
};
extern const struct price price_exact, price_fma, price_fast;

/* Prints the rows of this precision. Returns 0 if all went well. */
int price_run(struct gpu *g);

#ifdef __cplusplus
}
#endif
#endif
