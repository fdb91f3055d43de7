/* SPDX-License-Identifier: Apache-2.0 */
/* The update of one particle. spec/cloth/advance.md §1 */
#ifndef GPU_ADVANCE_CUH
#define GPU_ADVANCE_CUH

#include "gpu/base/real.cuh"

extern "C" {
#include "ref/cloth/advance.h"
}

/* Updates particle p: reads p in all streams, then writes x1 and v1, which may
 * be x and v. `force` and `at` replace the members of s. */
static __device__ inline void advance_particle(const struct advance *s,
                                               int64_t p, vec force, real at)
{
    vec x = s->x[p], v = s->v[p];
    uint8_t fixed = s->fixed[p];
    if (fixed == 0) {
        v = axpy(v, s->b / s->mass[p], force);
        x = axpy(x, s->a, s->symplectic ? v : s->rate[p]);
    } else if (fixed == CLOTH_PINNED) {
        vec d = sub(s->to[p], s->from[p]);
        x = at < 1 ? axpy(s->from[p], at, d) : s->to[p];
        v = scale(1 / s->dt, d);
    }
    s->x1[p] = x;
    s->v1[p] = v;
}

#endif
