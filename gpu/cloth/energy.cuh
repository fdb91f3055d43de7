/* SPDX-License-Identifier: Apache-2.0 */
/* Energies that stay on the device. spec/cloth/energy.md */
#ifndef GPU_ENERGY_CUH
#define GPU_ENERGY_CUH

#include "gpu/run/launch.cuh"

extern "C" {
#include "ref/cloth/energy.h"
}

/* Writes the three energies of s to the first bytes of word[0 … 2], in device
 * memory; word[0 … 3] must be 0 before. Overwrites s->chunk and leaves s->value
 * alone. */
void gpu_energy_into(struct gpu *g, const struct energy *s, int64_t *word);

/* Adds to word[1] what a panel's odd cells and stars add to the elastic energy
 * of s; word[3] must be 0 before. gpu/panel/panel.cu */
void gpu_panel_energy_into(struct gpu *g, const struct panel *panel,
                           const struct energy *s, int64_t *word);

#endif
