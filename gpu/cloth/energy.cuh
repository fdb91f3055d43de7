/* SPDX-License-Identifier: Apache-2.0 */
/* Energies that stay on the device. spec/cloth/energy.md */
#ifndef GPU_ENERGY_CUH
#define GPU_ENERGY_CUH

#include "gpu/run/launch.cuh"

extern "C" {
#include "ref/cloth/energy.h"
}

/* The three energies of s into the first bytes of word[0 … 2] on the device;
 * word[0 … 3] are 0 before. s->chunk is used up, s->value not written. */
void gpu_energy_into(struct gpu *g, const struct energy *s, int64_t *word);

#endif
