/* SPDX-License-Identifier: Apache-2.0 */
/* gpu_refit for who reads its words later. spec/broad/refit.md */
#ifndef GPU_REFIT_CUH
#define GPU_REFIT_CUH

#include "gpu/run/launch.cuh"

extern "C" {
#include "ref/broad/refit.h"
}

/* A position is bad, upon which nothing is written; how many boxes are made. */
enum { REFIT_BAD, REFIT_MADE, REFIT_WORDS };

/* gpu_refit, but what it returns and `made` stay in words, which are 0 before.
 */
void gpu_refit_queue(struct gpu *g, const struct refit *s, int64_t *words);

#endif
