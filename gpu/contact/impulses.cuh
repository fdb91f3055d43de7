/* SPDX-License-Identifier: Apache-2.0 */
/* As gpu/run/tape.cuh, and goes with it. */
#ifndef GPU_IMPULSES_CUH
#define GPU_IMPULSES_CUH

#include "gpu/run/tape.cuh"

static inline int gpu_impulses_of(struct gpu *g, struct impulses *s,
                                  struct amount, struct amount)
{
    return gpu_impulses(g, s);
}
static inline int gpu_contacts_of(struct gpu *g, struct contacts *s,
                                  struct amount, struct amount *vertices)
{
    int status = gpu_contacts(g, s);
    *vertices = {s->vertices, NULL};
    return status;
}

#endif
