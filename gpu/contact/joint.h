/* SPDX-License-Identifier: Apache-2.0 */
/* The joint solve of all cloths and their contacts on the device.
 * spec/contact/lagrange.md §3.2 */
#ifndef GPU_JOINT_H
#define GPU_JOINT_H

#include "gpu/run/gpu.h"
#include "ref/solve/joint.h"
#include "ref/solve/pcg.h"

#ifdef __cplusplus
extern "C" {
#endif

struct rate;
struct sewn;

/* One cloth in the joint solve. */
struct joint_part {
    struct pcg pcg;          /* its own system; block and packed are set */
    const struct rate *rate; /* of its springs; NULL: read blocks */
    int64_t first;           /* its first particle */
    int cloth;               /* its number in the world */
};

/* A contact of a vertex, and the vertex's weight in it. */
struct mutual {
    int32_t contact;
    real c;
};

/* The contacts as the kernels of a solve take them. In the lists of links all
 * contacts of a vertex stand, with obstacles, too; here those that are mutual,
 * in the same order. */
struct linked {
    struct links s;
    int32_t *end;        /* [nv] the lists begin at s.start and end here */
    struct mutual *item; /* [n4] */
};

/* The streams of a world that the joint solve reads and writes. */
struct joint_system {
    struct gpu *gpu;
    int n;                         /* cloths, ≥ 1 */
    const struct joint_part *part; /* host [n] */
    struct joint *joint;
    struct linked *links;  /* device [1] */
    int32_t *mutual_end;   /* device [nc], of *links */
    struct mutual *mutual; /* device [4 n], of *links */
    const real *w;         /* [nv] 1/kg, 0: fixed */
    struct sewn *sewn;     /* NULL: no seams, or no multigrid */
};

/* ref/solve/joint.h on the device, for the joint of *s. DRAPE_OK however the
 * iteration ends, or the status of a stage. What gpu_joint_system_set_up makes
 * is not lent, so any stage may come between these functions. measure and solve
 * wait for the device. */
int gpu_joint_system_set_up(const struct joint_system *s);
int gpu_joint_system_measure(const struct joint_system *s, const vec *r,
                             real *value);
int gpu_joint_system_solve(const struct joint_system *s);

#ifdef __cplusplus
}
#endif
#endif
