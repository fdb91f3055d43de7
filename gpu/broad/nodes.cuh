/* SPDX-License-Identifier: Apache-2.0 */
/* The tree's levels as kernels go through them. How many nodes a level has is
 * known on the device only, and waiting for it would cost more than threads
 * without a node: a level's kernel has about a quarter as many threads as the
 * one below, each of which takes every so-many-th node, so that any number of
 * threads will do. The levels of few nodes are one block's. */
#ifndef GPU_NODES_CUH
#define GPU_NODES_CUH

#include "gpu/broad/box.cuh"

extern "C" {
#include "ref/broad/tree.h"
}

enum { LEVEL_FEW = 1024 };

/* Threads for level l of a tree of n nodes. */
static inline int64_t level_threads(int64_t n, int l)
{
    return (n >> 2 * l) + 1;
}

/* The first of the levels that one block does; level 0 is none of them. */
static inline int level_top(int64_t n, int64_t levels)
{
    int l = 1;
    while (l < levels && level_threads(n, l) > LEVEL_FEW)
        l++;
    return l;
}

/* Node k of level l in the classes 0 … classes - 1, or -1. */
static __device__ inline int32_t level_node(const struct tree *t, int classes,
                                            int l, int64_t k)
{
    for (int c = 0; c < classes; c++) {
        const int32_t *run = t->range + c * t->levels + l;
        int32_t size = run[1] - run[0];
        if (k < size)
            return run[0] + (int32_t)k;
        k -= size;
    }
    return -1;
}

/* The loop of a thread over its nodes a of level l; tree is a struct tree. */
#define EACH_NODE(a, tree, classes, l)                                         \
    for (int64_t k_ = (int64_t)blockIdx.x * blockDim.x + threadIdx.x, a;       \
         (a = level_node(&(tree), classes, l, k_)) >= 0;                       \
         k_ += (int64_t)gridDim.x * blockDim.x)

#endif
