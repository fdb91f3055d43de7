/* SPDX-License-Identifier: Apache-2.0 */
/* The contacts' own matrix times a vector, as part of a solve.
 * spec/contact/penalty.md §3 */
#ifndef GPU_LINKS_CUH
#define GPU_LINKS_CUH

#include "gpu/contact/contact.cuh"

extern "C" {
#include "ref/contact/links.h"
}

/* Queues y += C x. links is in device memory, so that a captured graph stays
 * valid when contacts change; its x and y are not read. go: NULL, or on the
 * device: nothing is done if *go is 0. */
void gpu_links_queue(struct gpu *g, const struct links *links, int64_t nv,
                     const vec *x, vec *y, const int32_t *go);

#endif
