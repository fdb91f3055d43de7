/* SPDX-License-Identifier: Apache-2.0 */
/* Bulk copies from global to shared memory (cp.async.bulk). The hardware makes
 * them asynchronously, so that no thread needs registers for bytes in flight.
 */
#ifndef GPU_BULK_CUH
#define GPU_BULK_CUH

#include "gpu/base/cluster.cuh"

/* An mbarrier for a number of copies that are made together, in rounds. One
 * thread calls bulk_open before a barrier of the block. In each round as many
 * threads call bulk_ask, each for one copy (addresses and bytes are multiples
 * of 16; bytes may be 0), and all threads of the block call bulk_wait. On a
 * device without bulk copies bulk_ask copies at once, and the caller's barrier
 * between bulk_ask and use of the bytes makes them visible. */
typedef uint64_t bulk;

#if defined __CUDA_ARCH__ && __CUDA_ARCH__ >= 900
static __device__ inline unsigned shared_at(const void *p)
{
    return (unsigned)__cvta_generic_to_shared(p);
}

static __device__ inline void bulk_open(bulk *b, int copies)
{
    asm volatile("mbarrier.init.shared::cta.b64 [%0], %1;\n"
                 "fence.mbarrier_init.release.cluster;" ::"r"(shared_at(b)),
                 "r"(copies)
                 : "memory");
}

static __device__ inline void bulk_ask(bulk *b, void *to, const void *from,
                                       int bytes)
{
    asm volatile("mbarrier.arrive.expect_tx.shared::cta.b64 _, [%0], %1;" ::"r"(
                     shared_at(b)),
                 "r"(bytes)
                 : "memory");
    uint64_t once;
    asm("createpolicy.fractional.L2::evict_first.b64 %0;" : "=l"(once));
    if (bytes > 0)
        asm volatile(
            "cp.async.bulk.shared::cluster.global.mbarrier::complete_tx::bytes"
            ".L2::cache_hint [%0], [%1], %2, [%3], %4;" ::"r"(shared_at(to)),
            "l"(from), "r"(bytes), "r"(shared_at(b)), "l"(once)
            : "memory");
}

static __device__ inline void bulk_wait(bulk *b, int round)
{
    unsigned done = 0;
    while (!done)
        asm volatile("{\n"
                     ".reg .pred p;\n"
                     "mbarrier.try_wait.parity.shared::cta.b64 p, [%1], %2;\n"
                     "selp.u32 %0, 1, 0, p;\n"
                     "}"
                     : "=r"(done)
                     : "r"(shared_at(b)), "r"(round % 2)
                     : "memory");
}
#elif defined __CUDACC__
static __device__ inline void bulk_open(bulk *, int) {}
static __device__ inline void bulk_wait(bulk *, int) {}

static __device__ inline void bulk_ask(bulk *, void *to, const void *from,
                                       int bytes)
{
    memcpy(to, from, (size_t)bytes);
}
#else
static inline void bulk_open(bulk *b, int copies)
{
    (void)copies;
    *b = 0;
}

static inline void bulk_ask(bulk *b, void *to, const void *from, int bytes)
{
    (void)b;
    emulate_copy(to, from, (size_t)bytes);
}

/* The copies of all rounds are made here, as late as is allowed. */
static inline void bulk_wait(bulk *b, int round)
{
    (void)b;
    (void)round;
    emulate_copies_group();
    emulate_copies_end(0);
    emulate_meet();
}
#endif

#endif
