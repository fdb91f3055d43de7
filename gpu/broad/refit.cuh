/* SPDX-License-Identifier: Apache-2.0 */
/* A form of gpu_refit for callers that read its status back later.
 * spec/broad/refit.md */
#ifndef GPU_REFIT_CUH
#define GPU_REFIT_CUH

#include "gpu/run/launch.cuh"

extern "C" {
#include "ref/broad/refit.h"
}

/* Words of gpu_refit_queue: nonzero if a position is bad, and then no box is
 * written; the number of boxes made. */
enum { REFIT_BAD, REFIT_MADE, REFIT_WORDS }; /* late: before contacts' */

/* Queues gpu_refit. Its status and `made` stay on the device in words, which
 * must be 0 before. */
void gpu_refit_queue(struct gpu *g, const struct refit *s, int64_t *words);

#endif
