/* SPDX-License-Identifier: Apache-2.0 */
/* What the files of branch `pipe` still call of the tape, which is gone; at the
 * merge this file goes, and gpu/contact/impulses.cuh, and struct gpu's tape and
 * changes. */
#ifndef GPU_TAPE_CUH
#define GPU_TAPE_CUH

#include "gpu/run/gpu.cuh"

struct tape_key {
    const void *bytes;
    size_t n;
};
enum { TAPE_TOLD = 16, TAPE_OFF = 0, TAPE_RECORDS = 1 };
struct amount {
    int64_t most;
    const int64_t *at;
};
static __device__ inline int64_t number(struct amount n)
{
    return n.most;
}
static inline void gpu_tape_begin(struct gpu *, struct tape_key,
                                  const int64_t *, int)
{
}
static inline void gpu_tape_end(struct gpu *) {}
static inline void gpu_tape_done(struct gpu *) {}
static inline const int64_t *gpu_told(struct gpu *)
{
    return NULL;
}
static inline void gpu_expect(struct gpu *, int, int64_t, int64_t) {}
static inline void gpu_fence(struct gpu *) {}
static inline void gpu_once(struct gpu *) {}
static inline void gpu_keep(struct gpu *, const void *, int) {}
static inline void gpu_keep_found(struct gpu *, const void *) {}
static inline const int64_t *gpu_recall(const struct gpu *, const void *)
{
    return NULL;
}
static inline int64_t gpu_room(const struct gpu *, int64_t n)
{
    return n;
}
static inline struct amount gpu_amount_at(const struct gpu *, int64_t n,
                                          const int64_t *)
{
    return {n, NULL};
}
static inline struct amount gpu_amount(const struct gpu *, int64_t n)
{
    return {n, NULL};
}

struct penalty;
int gpu_penalty_queue(struct gpu *g, struct penalty *s, int64_t *words);
static inline int gpu_penalty_queue(struct gpu *g, struct penalty *s,
                                    struct amount, int64_t *words)
{
    return gpu_penalty_queue(g, s, words);
}

#endif
