/* SPDX-License-Identifier: Apache-2.0 */
/* What the block of a spring is made of, for the springs of a grid and for
 * those of the odd cells of a panel. spec/cloth/blocks.md §1, §8 */
#ifndef GPU_PARTS_CUH
#define GPU_PARTS_CUH

#include "gpu/cloth/cloth.cuh"
#include "gpu/cloth/rate.cuh"

extern "C" {
#include "ref/cloth/blocks.h"
}

/* §1: the block f fᵀ + b I, f = √c u, where c = a - b and u is the direction.
 */
struct parts {
    real b, c;
    vec u;
};

/* §8: the direction of a spring whose ends are d apart, l = |d|, half way
 * through the predicted motion, in which they move apart by 2·way. */
static __device__ inline vec spring_direction(vec d, real l, vec way)
{
    real size = length(way), most = R(BLOCKS_ROTATION) * l;
    if (size > most)
        way = scale(most / size, way);
    vec e = add(d, way);
    real turned = length(e);
    return turned > 0 ? scale(1 / turned, e) : scale(1 / l, d);
}

/* d: from the spring's start to its end; dq: the same of the predicted motion.
 * t: the cloth's pieces. */
static __device__ inline struct parts spring_parts(const struct law *law,
                                                   const struct piece *t,
                                                   real tau, vec d, vec dq)
{
    real l = length(d);
    if (!(l > 0))
        return parts{0, 0, make(0, 0, 0)};
    real square = tau * tau;
    real a = tau * law->damp + square * spring_slope(law, t, l);
    real b = square * max_of(spring_tension(law, t, l) / l, R(0));
    return parts{b, a - b, spring_direction(d, l, scale(R(0.5) * tau, dq))};
}

static __device__ inline struct rate rate_of(const struct parts *s)
{
    return {s->b, scale(sqrt(max_of(s->c, R(0))), s->u)};
}

#endif
