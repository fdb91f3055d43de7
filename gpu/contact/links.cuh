/* SPDX-License-Identifier: Apache-2.0 */
/* The contacts' own matrix times a vector, as part of a solve.
 * spec/contact/penalty.md §3 */
#ifndef GPU_LINKS_CUH
#define GPU_LINKS_CUH

#include "gpu/contact/contact.cuh"

extern "C" {
#include "ref/contact/links.h"
}

/* The contacts as the kernels of a solve take them. In the lists of links all
 * contacts of a vertex stand, with obstacles, too; here those that are mutual,
 * in the same order. */
struct linked {
    struct links s;
    int32_t *end;  /* [nv] the lists begin at s.start and end here */
    int32_t *item; /* [n4] */
};

/* Queues the writing of *to, in device memory, and of end and item. nv:
 * vertices whose lists are wanted; of s, x and y are not read. */
void gpu_links_keep(struct gpu *g, const struct links *s, int64_t nv,
                    struct linked *to, int32_t *end, int32_t *item);

/* Queues y += C x. links is in device memory, so that a captured graph stays
 * valid when contacts change. go: NULL, or on the device: nothing is done if
 * *go is 0. */
void gpu_links_queue(struct gpu *g, const struct linked *links, int64_t nv,
                     const vec *x, vec *y, const int32_t *go);

#endif
