/* SPDX-License-Identifier: Apache-2.0 */
/* The rates of springs: a compact form of their blocks. They give the same
 * block to the last bit at two thirds of the bytes; for products that are bound
 * by memory. spec/cloth/blocks.md §6 */
#ifndef GPU_RATE_H
#define GPU_RATE_H

#ifdef __cplusplus
extern "C" {
#endif

#include "gpu/run/gpu.h"
#include "ref/base/real.h"

/* The block along alongᵀ + across I of a spring. */
struct rate {
    real across; /* kg */
    vec along;   /* √kg */
};

/* Whether a solve of this form reads rates on this device. */
bool gpu_rates_help(const struct gpu *g, const struct pcg *s);
/* As gpu_blocks; also writes rate [SPRINGS·count] in device memory, spring o of
 * p at o·count + p, unless NULL. */
int gpu_blocks_and_rates(struct gpu *g, const struct blocks *s,
                         struct rate *rate);
/* As gpu_pcg, to the same bits, but reads these rates unless NULL. */
int gpu_pcg_by_rates(struct gpu *g, struct pcg *s, const struct rate *rate);

#ifdef __cplusplus
}
#endif
#endif
