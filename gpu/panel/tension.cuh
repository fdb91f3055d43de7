/* SPDX-License-Identifier: Apache-2.0 */
/* The energy of a panel's odd cells and stars that stays on the device.
 * spec/panel/tension.md */
#ifndef GPU_TENSION_CUH
#define GPU_TENSION_CUH

#include "gpu/run/launch.cuh"

extern "C" {
#include "ref/panel/tension.h"
}

/* Adds the energy to the real at `word`, in device memory. `ticket`, there,
 * too, must be 0, and is again. Overwrites s->chunk and leaves s->value alone.
 */
void gpu_tension_into(struct gpu *g, const struct tension *s, int64_t *word,
                      int64_t *ticket);

#endif
