/* SPDX-License-Identifier: Apache-2.0 */
/* Loops over the levels of the tree. Only the device knows how many nodes a
 * level has, and a readback would cost more than idle threads. So a level's
 * kernel has about a quarter of the threads of the level below, and each thread
 * goes through nodes in a grid-stride loop, so that any number of threads is
 * correct. One block does all levels of few nodes. */
#ifndef GPU_NODES_CUH
#define GPU_NODES_CUH

#include "gpu/broad/box.cuh"

extern "C" {
#include "ref/broad/tree.h"
}

enum { LEVEL_FEW = 1024 };

/* Returns the number of threads for level l of a tree of n nodes. */
static inline int64_t level_threads(int64_t n, int l)
{
    return (n >> 2 * l) + 1;
}

/* Returns the first of the levels that one block does; at least 1. */
static inline int level_top(int64_t n, int64_t levels)
{
    int l = 1;
    while (l < levels && level_threads(n, l) > LEVEL_FEW)
        l++;
    return l;
}

/* Returns node k of level l in the classes 0 … classes - 1, or -1. */
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

/* A thread's loop over its nodes a of level l; `tree` is a struct tree. */
#define EACH_NODE(a, tree, classes, l)                                         \
    for (int64_t k_ = (int64_t)blockIdx.x * blockDim.x + threadIdx.x, a;       \
         (a = level_node(&(tree), classes, l, k_)) >= 0;                       \
         k_ += (int64_t)gridDim.x * blockDim.x)

#endif
