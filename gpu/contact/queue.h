/* SPDX-License-Identifier: Apache-2.0 */
/* Forms of the stages of contacts in a solve for callers that do not wait for
 * their status. spec/contact/carry.md, spec/contact/coulomb.md */
#ifndef GPU_CONTACT_QUEUE_H
#define GPU_CONTACT_QUEUE_H

#include "gpu/run/gpu.h"

#ifdef __cplusplus
extern "C" {
#endif

struct carry;
struct coulomb;
struct retain;

/* As gpu_carry, gpu_retain and gpu_coulomb, but without reading back. *bad, 0
 * before, is on the device and becomes 1 if a contact has a bad vertex; such
 * contacts are left out. words: those of gpu_incidence. */
int gpu_carry_queue(struct gpu *g, const struct carry *s, int64_t *bad);
int gpu_retain_queue(struct gpu *g, const struct retain *s, int64_t *bad);
int gpu_coulomb_queue(struct gpu *g, struct coulomb *s, int64_t *words);
/* Late words for these functions, and whether one of them has found a bad
 * contact, by the last readback: gpu_late_words, gpu_late_seen. */
int64_t *gpu_queue_words(struct gpu *g);
bool gpu_queue_bad(const struct gpu *g);

#ifdef __cplusplus
}
#endif
#endif
