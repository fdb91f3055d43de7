/* SPDX-License-Identifier: Apache-2.0 */
/* Stages of a round as a slice on a tape calls them: as gpu_impulses and
 * gpu_contacts, but how many items there are the device may find. */
#ifndef GPU_IMPULSES_CUH
#define GPU_IMPULSES_CUH

#include "gpu/run/tape.cuh"
#include "ref/contact/contacts.h"
#include "ref/contact/impulses.h"

int gpu_impulses_of(struct gpu *g, struct impulses *s, struct amount impacts,
                    struct amount active);
/* s has the room of n.most contacts. *vertices: as s->vertices. */
int gpu_contacts_of(struct gpu *g, struct contacts *s, struct amount n,
                    struct amount *vertices);

/* gpu_penalty_queue as it is without a tape: goes with this file. */
#include "gpu/contact/incidence.cuh"
static inline int gpu_penalty_queue(struct gpu *g, struct penalty *s,
                                    int64_t *words)
{
    return gpu_penalty_queue(g, s, amount{s->n, NULL}, words);
}

#endif
