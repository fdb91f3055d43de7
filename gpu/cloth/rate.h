/* SPDX-License-Identifier: Apache-2.0 */
/* The rates of springs: a compact form of their blocks. With the positions,
 * rates give the same block to the last bit at half the bytes; for products
 * that are bound by memory. spec/cloth/blocks.md §6 */
#ifndef GPU_RATE_H
#define GPU_RATE_H

#ifdef __cplusplus
extern "C" {
#endif

#include "gpu/run/gpu.h"
#include "ref/base/real.h"

/* The block along u uᵀ + across I of a spring from p to q, where u =
 * inverse·(x_q - x_p). */
struct rate {
    real across, along, inverse; /* kg, kg, 1/m */
};

/* Rates that the device copies at once. */
enum { RATES_AT_ONCE = 4 };

/* Rates from one direction to the next: count, rounded up to whole copies. */
#define RATES_PITCH(count)                                                     \
    (((count) + RATES_AT_ONCE - 1) / RATES_AT_ONCE * RATES_AT_ONCE)

/* The rates of a system, in device memory. */
struct rates {
    const struct rate *of; /* spring o of p at o·pitch + p; NULL: none */
    const vec *x;          /* [count] m, positions that the blocks are of */
};

/* Whether a solve of this form reads rates on this device. */
bool gpu_rates_help(const struct gpu *g, const struct pcg *s);
/* As gpu_blocks; also writes rate [SPRINGS·pitch] in device memory, unless
 * NULL. */
int gpu_blocks_and_rates(struct gpu *g, const struct blocks *s,
                         struct rate *rate);
/* As gpu_pcg, to the same bits, but reads the rates r unless r.of is NULL. */
int gpu_pcg_by_rates(struct gpu *g, struct pcg *s, struct rates r);

#ifdef __cplusplus
}
#endif
#endif
