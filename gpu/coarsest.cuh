/* SPDX-License-Identifier: Apache-2.0 */
/* The coarsest grid on the device. spec/14_multigrid.md §5 */
#ifndef GPU_COARSEST_CUH
#define GPU_COARSEST_CUH

#include "gpu/grid.cuh"
#include "ref/coarsest.h"

/* Fills s.dense with L and 1/D. */
void gpu_coarsest_factor(struct gpu *g, const struct coarsest *s);

/* z = A⁻¹ b; nothing where *go is 0, go being NULL or on the device. */
void gpu_coarsest_solve(struct gpu *g, const struct coarsest *s, const vec *b,
                        vec *z, const int32_t *go);

#endif
