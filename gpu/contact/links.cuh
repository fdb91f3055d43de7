/* SPDX-License-Identifier: Apache-2.0 */
/* The contacts' own matrix times a vector, as part of a solve.
 * spec/contact/coulomb.md §3 */
#ifndef GPU_LINKS_CUH
#define GPU_LINKS_CUH

#include "gpu/base/real.cuh"
#include "gpu/contact/lists.cuh"

extern "C" {
#include "gpu/contact/joint.h"
}

/* Queues the writing of *to, in device memory, and of end and item. nv:
 * vertices whose lists are wanted; of s, x and y are not read. */
void gpu_links_keep(struct gpu *g, const struct links *s, int64_t nv,
                    struct linked *to, int32_t *end, struct mutual *item);

/* The pushes of the mutual contacts of a vertex, which add to y. A contact that
 * is not would add 0, which changes no y, as no y is -0. */
struct links_list {
    const struct links *s;
    const int32_t *start, *past;
    const struct mutual *item;
    vec *y;
    __device__ int32_t end(int64_t i) const { return past[i]; }
    __device__ vec value(int32_t at) const
    {
        struct mutual m = item[at];
        return scale(m.c, s->push[m.contact]);
    }
    __device__ vec first(int64_t i) const { return y[i]; }
    __device__ void done(int64_t i, vec sum) const { y[i] = sum; }
};

/* Adds to y of the vertex of a thread of a block of LIST_BLOCK, of nv vertices,
 * the pushes of its contacts, in the order of its list. All threads must call
 * it; y is seen by all after a barrier. */
static __device__ inline void gather_links(const struct linked *l, int64_t nv,
                                           vec *y)
{
    struct links_list list = {&l->s, l->s.start, l->end, l->item, y};
    int64_t i = own_list(nv);
    sum_list(list, i >= 0 && list.start[i] == list.past[i] ? -1 : i);
}

/* Queues y += C x, in two kernels: the pushes of the contacts in answer to x,
 * and their sums. links is in device memory, so that a captured graph stays
 * valid when contacts change. go: NULL, or on the device: nothing is done if
 * *go is 0. */
void gpu_links_queue(struct gpu *g, const struct linked *links, int64_t nv,
                     const vec *x, vec *y, const int32_t *go);
void gpu_links_push(struct gpu *g, const struct linked *links, const vec *x,
                    const int32_t *go);

#endif
