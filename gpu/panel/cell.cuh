/* SPDX-License-Identifier: Apache-2.0 */
/* The corners of an odd cell and its forms, which the three stages of a panel
 * share. spec/panel/panel.md */
#ifndef GPU_CELL_CUH
#define GPU_CELL_CUH

#include "gpu/cloth/cloth.cuh"

extern "C" {
#include "ref/panel/lists.h"
}

/* What corners 1 to 3 of a cell have more than corner 0. */
struct beyond {
    vec of[3];
};

static __device__ inline struct beyond beyond_of(const vec *a,
                                                 const int32_t corner[4])
{
    vec first = a[corner[0]];
    return {{sub(a[corner[1]], first), sub(a[corner[2]], first),
             sub(a[corner[3]], first)}};
}

/* The form of fibre f, of such differences. */
static __device__ inline vec form_at(const struct fibre *f,
                                     const struct beyond *a)
{
    vec d = axpy(make(0, 0, 0), f->c[0], a->of[0]);
    return axpy(axpy(d, f->c[1], a->of[1]), f->c[2], a->of[2]);
}

/* The direction of springs whose law fibre f has. */
static __device__ inline int law_at(int f)
{
    return f < 4 ? f / 2 : f - 2;
}

#endif
