/* SPDX-License-Identifier: Apache-2.0 */
/* Which contacts each free vertex is in, on the device.
 * spec/contact/contacts.md §1 */
#ifndef GPU_INCIDENCE_CUH
#define GPU_INCIDENCE_CUH

#include "gpu/contact/contact.cuh"
#include "ref/contact/incidence.h"

/* Words that gpu_incidence writes: whether a contact names no vertex, and
 * then nothing else is valid; free vertices in contact. */
enum { INCIDENCE_BAD, INCIDENCE_VERTICES, INCIDENCE_WORDS };

/* As ref_incidence, but `vertices` goes
 * to words, which are zero before. Uses scratch slots 0 to 2. Returns where
 * each item [4 n] is in the lists, -1: it is not, in slot 1. */
int32_t *gpu_incidence(struct gpu *g, const struct incidence *s,
                       int64_t *words);

/* gpu_penalty, but what gpu_incidence writes stays in words; where a contact
 * is bad, force and hold are 0. */
struct penalty;
int gpu_penalty_queue(struct gpu *g, struct penalty *s, int64_t *words);

#endif
