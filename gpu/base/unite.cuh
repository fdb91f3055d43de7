/* SPDX-License-Identifier: Apache-2.0 */
/* Connected components by labels that threads lower at the same time: the label
 * of an item leads to the first item of its component. spec/contact/zones.md §1
 */
#ifndef GPU_UNITE_CUH
#define GPU_UNITE_CUH

#include "gpu/base/real.cuh"

/* The root of item i: the end of its chain of labels. Other threads lower
 * labels meanwhile, along the same chains. Each label on the way is replaced by
 * its label's label (path halving), which keeps chains short and their roots
 * the same, whichever thread does it. */
static __device__ inline int32_t root_of(volatile int32_t *label, int32_t i)
{
    int32_t at = label[i];
    for (int32_t to = label[at]; to != at; to = label[at]) {
        label[i] = to;
        i = at;
        at = to;
    }
    return at;
}

/* Joins the components of a and b: the larger root gets the smaller root as its
 * label, by compare and swap, if it is still a root. Labels only decrease, so
 * the root that is left is the smallest item of the component. */
static __device__ inline void unite(int32_t *label, int32_t a, int32_t b)
{
    a = root_of(label, a);
    b = root_of(label, b);
    while (a != b) {
        int32_t hi = max_of(a, b), lo = min_of(a, b);
        int32_t old = atomicCAS(&label[hi], hi, lo);
        if (old == hi)
            return;
        a = root_of(label, old);
        b = root_of(label, lo);
    }
}

#endif
