/* SPDX-License-Identifier: Apache-2.0 */
/* Stage springs as a kernel of its own, which writes the forces to a stream.
 * spec/cloth/springs.md */
#include "gpu/cloth/springs.cuh"

namespace
{

/* Particle p's thread writes force[p]. */
struct force_stream {
    vec *force;
    __device__ void take(int p, vec f) const { force[p] = f; }
};

} // namespace

int gpu_springs(struct gpu *g, struct springs *s)
{
    if (s->n_u)
        springs_to<1>(g, s, force_stream{s->force});
    else
        springs_to<0>(g, s, force_stream{s->force});
    return gpu_status(g);
}
