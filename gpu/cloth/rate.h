/* SPDX-License-Identifier: Apache-2.0 */
/* Springs by their rates: half the bytes of their blocks, which the positions
 * make of them to the last bit. For products that are bound by bytes.
 * spec/cloth/blocks.md §6 */
#ifndef GPU_RATE_H
#define GPU_RATE_H

#ifdef __cplusplus
extern "C" {
#endif

#include "gpu/base/stages.h"
#include "ref/base/real.h"

/* The block is along u uᵀ + across I, u = inverse (x_q - x_p). */
struct rate {
    real across, along, inverse; /* kg, kg, 1/m */
};

/* So many are copied at once. */
enum { RATES_AT_ONCE = 4 };

/* From those of a direction to those of the next. */
#define RATES_PITCH(count)                                                     \
    (((count) + RATES_AT_ONCE - 1) / RATES_AT_ONCE * RATES_AT_ONCE)

/* Those of a system, on the device. */
struct rates {
    const struct rate *of; /* spring o of p at o·pitch + p; NULL: none */
    const vec *x;          /* [count] m, where the blocks were made */
};

/* Whether a solve of this form would read them on this device. */
bool gpu_rates_help(const struct gpu *g, const struct pcg *s);
/* gpu_blocks, and rate [SPRINGS·pitch] on the device; NULL: none. */
int gpu_blocks_and_rates(struct gpu *g, const struct blocks *s,
                         struct rate *rate);
/* gpu_pcg, the same bits; r.of NULL: just that. */
int gpu_pcg_by_rates(struct gpu *g, struct pcg *s, struct rates r);

#ifdef __cplusplus
}
#endif
#endif
