/* SPDX-License-Identifier: Apache-2.0 */
/* The contacts of each free vertex, on the device.
 * spec/contact/contacts.md §1 */
#ifndef GPU_INCIDENCE_CUH
#define GPU_INCIDENCE_CUH

#include "gpu/contact/contact.cuh"

extern "C" {
#include "ref/contact/incidence.h"
}

/* Words that gpu_incidence writes. BAD: not 0 if a contact has a bad vertex;
 * the rest is then undefined. VERTICES: the number of free vertices in contact.
 */
enum { INCIDENCE_BAD, INCIDENCE_VERTICES, INCIDENCE_WORDS };

/* As ref_incidence, but `vertices` goes to `words`, which must be zero before.
 * Uses scratch slots 0 to 2. Returns the place of each item in the lists, [4 n]
 * in slot 1; -1: the item is in no list. */
int32_t *gpu_incidence(struct gpu *g, const struct incidence *s,
                       int64_t *words);

#endif
