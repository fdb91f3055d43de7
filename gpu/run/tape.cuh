/* SPDX-License-Identifier: Apache-2.0 */
/* A step on a tape: one CUDA graph of what the host queued for a step like it,
 * so that it issues one launch. The host follows with the same code, in which
 * launches are left out and looks read what the graph shows, and so decides all
 * that it always does; where the device finds that a decision would not be the
 * recorded one, the graph ends there, and the host goes on by itself.
 * spec/gpu.md §13 */
#ifndef GPU_TAPE_CUH
#define GPU_TAPE_CUH

#include "gpu/run/gpu.cuh"

/* All that the launches of a step depend on but memory (gpu.changes) and what
 * looks show, as plain bytes. */
struct tape_key {
    const void *bytes;
    size_t n;
};

/* What the device can be told that changes from step to step. */
enum { TAPE_TOLD = 16 };

/* How many items a stream has: `most`, or on a tape as many as the device finds
 * in *at, and then most is what there is room for. */
struct amount {
    int64_t most;
    const int64_t *at; /* device, or NULL */
};

static __device__ inline int64_t number(struct amount n)
{
    int64_t k = n.at ? *n.at : n.most;
    return k <= n.most ? k : 0; /* more: the tape ends at its next fence */
}

/* From here to gpu_tape_end launches are recorded, or one graph has made them,
 * or neither. The host tells the device what is in told [n ≤ TAPE_TOLD]. */
void gpu_tape_begin(struct gpu *g, struct tape_key key, const int64_t *told,
                    int n);
/* Nothing to do where no tape is on. */
void gpu_tape_end(struct gpu *g);
/* The same where the step ends, too. */
void gpu_tape_done(struct gpu *g);
/* What is recorded misses something, so that there is no more of it. */
void gpu_tape_spoil(struct gpu *g);
void gpu_tapes_close(struct gpu *g);

/* The next thing that the host tells, in the order in which it is asked for;
 * NULL where no tape is on. */
const int64_t *gpu_told(struct gpu *g);

/* Of the last look, where a tape is recorded: the tape ends there unless a word
 * is from least to most, a half of one (0: the low one) is a value. */
void gpu_expect(struct gpu *g, int word, int64_t least, int64_t most);
void gpu_expect_half(struct gpu *g, int word, int half, int32_t value);
/* At most cap; some: where it is 0 now, that, else not 0, and no more than
 * gpu_room of what it is. A tape that has no room for more is of no more use.
 */
void gpu_expect_room(struct gpu *g, int word, int64_t cap);
void gpu_expect_some(struct gpu *g, int word, int64_t cap);
/* That what gpu_late_words are about is not bad, which the first of them says.
 */
static inline void gpu_expect_no_late(struct gpu *g)
{
    gpu_expect(g, (int)GPU_WORDS, 0, 0);
}
/* Behind a look and what is expected of it: where that is not so nothing of the
 * rest is done. Elsewhere the tape goes on to the next fence. */
void gpu_fence(struct gpu *g);
/* Before what must not be done twice: the last look is a fence from here on, or
 * the tape goes no further. */
void gpu_once(struct gpu *g);

/* Where a word of the last look stays on the device until the step ends; NULL
 * where no tape is recorded. */
const int64_t *gpu_kept(const struct gpu *g, int word);

/* That word of the last look, on the device, for `who` to be recalled in the
 * same step; NULL where nothing was kept for him, or no tape is recorded. */
void gpu_keep(struct gpu *g, const void *who, int word);
void gpu_keep_found(struct gpu *g, const void *who); /* the word of gpu.found */
const int64_t *gpu_recall(const struct gpu *g, const void *who);

/* Room for n items: where a tape is recorded for some more, in steps to come.
 * None for none, as what has no items is not launched then. */
static inline int64_t gpu_room(const struct gpu *g, int64_t n)
{
    return g->tape == TAPE_RECORDS && n && !g->tight ? n + n / 4 + 64 : n;
}

/* Where a choice of kernels depends on n: what it was when that was recorded.
 */
int64_t gpu_recorded(struct gpu *g, int64_t n);

/* For who looks: whether a tape shows it; else where words are to be kept on
 * the device, or NULL. */
bool gpu_tape_shows(struct gpu *g, bool clear);
int64_t *gpu_tape_looks(struct gpu *g, bool clear);

/* Of n items, which are as many as the device finds at `at`. */
static inline struct amount gpu_amount_at(const struct gpu *g, int64_t n,
                                          const int64_t *at)
{
    return {at ? gpu_room(g, n) : n, at};
}
/* The same, as the last stage that found some left them. */
static inline struct amount gpu_amount(const struct gpu *g, int64_t n)
{
    return gpu_amount_at(g, n, g->found);
}

#endif
