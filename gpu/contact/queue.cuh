/* SPDX-License-Identifier: Apache-2.0 */
/* Forms of the stages of contacts in a solve for callers that do not wait for
 * their status. spec/contact/carry.md, spec/contact/coulomb.md */
#ifndef GPU_CONTACT_QUEUE_CUH
#define GPU_CONTACT_QUEUE_CUH

#include "gpu/run/launch.cuh"

extern "C" {
#include "ref/contact/carry.h"
#include "ref/contact/coulomb.h"
}

/* As gpu_carry, gpu_retain and gpu_coulomb, but without reading back. *bad, 0
 * before, is on the device and becomes 1 if a contact has a bad vertex; such
 * contacts are left out. words: those of gpu_incidence. */
int gpu_carry_queue(struct gpu *g, const struct carry *s, int64_t *bad);
int gpu_retain_queue(struct gpu *g, const struct retain *s, int64_t *bad);
int gpu_coulomb_queue(struct gpu *g, struct coulomb *s, int64_t *words);

#endif
