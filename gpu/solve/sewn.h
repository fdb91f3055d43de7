/* SPDX-License-Identifier: Apache-2.0 */
/* One V-cycle over all cloths that seams join, on the device.
 * spec/solve/sewn.md */
#ifndef GPU_SEWN_H
#define GPU_SEWN_H

#include "gpu/run/gpu.h"
#include "ref/base/real.h"

#ifdef __cplusplus
extern "C" {
#endif

struct multigrid;
struct sewn;

/* Copies the lists of *from to the device and takes scratch there. NULL if
 * there is no memory. */
struct sewn *gpu_sewn_make(struct gpu *g, struct arena *host,
                           const struct sewn *from);
/* Before all that follows, in this order: none of the cloths takes part; but
 * cloth k does, with its r and z; and that is sent. lent: as in
 * gpu/solve/level.cuh; item: [count] becomes z·r. */
void gpu_sewn_clear(struct sewn *s);
void gpu_sewn_put(struct sewn *s, int k, const struct multigrid *grid,
                  sym *lent, real *item);
void gpu_sewn_send(struct gpu *g, struct sewn *s);
/* After the cloths' own preconditioners and kappa: adds the links to the
 * factors and inverts the last grids. */
void gpu_sewn_set_up(struct gpu *g, const struct sewn *s);
/* All between the products of the finest grids on the way down and on the way
 * up; and what the links do after the latter. go: on the device; if *go is 0
 * nothing is done. */
void gpu_sewn_cycle(struct gpu *g, const struct sewn *s, const int32_t *go);
void gpu_sewn_finish(struct gpu *g, const struct sewn *s, const int32_t *go);

#ifdef __cplusplus
}
#endif
#endif
