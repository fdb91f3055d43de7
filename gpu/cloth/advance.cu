/* SPDX-License-Identifier: Apache-2.0 */
/* Stage advance as a kernel of its own, which reads the forces from a stream.
 * spec/cloth/advance.md */
#include "gpu/cloth/advance.cuh"

/* Thread p owns particle p in every stream. Any order. */
KERNEL advance_kernel(const struct advance &s)
{
    ITEM(p, s.count);
    advance_particle(&s, p, s.force[p], s.at);
}

int gpu_advance(struct gpu *g, struct advance *s)
{
    LAUNCH(g, s->count, advance_kernel, *s);
    return gpu_status(g);
}
