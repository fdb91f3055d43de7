/* SPDX-License-Identifier: Apache-2.0 */
/* What of a tape is the device's: gpu/run/reel.cu, emulated
 * gpu/run/emulate_reel.cpp; gpu/run/tape.cu decides when. A reel holds
 * launches, loops and looks in their order; at a look the device judges whether
 * the rest is to be done. */
#ifndef GPU_REEL_CUH
#define GPU_REEL_CUH

#include "gpu/run/loop.cuh"
#include "gpu/run/tape.cuh"

/* Looks of a tape, and what is expected of one. */
enum { REEL_LOOKS = 48, REEL_EXPECTED = 8 };

/* Of a look: on, or the step goes another way, or there is no room for it. */
enum verdict { GOES_ON, ENDS, NO_ROOM };

/* A word, or half of one (half < 0: the whole), of a look: from least to most;
 * room: more is NO_ROOM. */
struct expect {
    int word, half;
    bool room;
    int64_t least, most;
};

struct expected {
    int n;
    struct expect of[REEL_EXPECTED];
};

/* What a look shows the host: words, verdict, and a mark, not 0, that comes
 * last; and what it keeps on the device: words. Behind all of them lies what
 * the host tells, there with the tape's verdict. */
enum { VERDICT = GPU_ALL_WORDS, MARK, SLOT };
struct reel_memory {
    int64_t *shown, *kept;
};
static inline int64_t *shown_of(struct reel_memory m, int look)
{
    return m.shown + (int64_t)look * SLOT;
}
static inline int64_t *kept_of(struct reel_memory m, int look)
{
    return m.kept + (int64_t)look * GPU_ALL_WORDS;
}
static inline int64_t *told_of(struct reel_memory m)
{
    return kept_of(m, REEL_LOOKS);
}

/* One look. */
struct reel_look {
    int number;
    bool clear, fence; /* words after it; nothing goes on that it ends */
    struct expected expected;
};

static __device__ inline int64_t value_of(int64_t word, const struct expect *e)
{
    return e->half < 0 ? word : (int32_t)(word >> 32 * e->half);
}

/* Of a look whose words are kept, by the verdict so far. */
static __device__ inline int64_t judge(const struct reel_look *k,
                                       const int64_t *kept, const int64_t *told)
{
    int64_t verdict = told[TAPE_TOLD];
    for (int j = 0; verdict == GOES_ON && j < k->expected.n; j++) {
        const struct expect *e = &k->expected.of[j];
        int64_t value = value_of(kept[e->word], e);
        if (value < e->least || value > e->most)
            verdict = e->room && value > e->most ? NO_ROOM : ENDS;
    }
    bool falters = told[TAPE_TOLD - 1] == k->number;
    return verdict == GOES_ON && falters ? (int64_t)ENDS : verdict;
}

struct reel;

/* Takes both memories, once. false: there is none, or no such tapes. */
bool reel_open(struct gpu *g, struct reel_memory *m);
void reel_close(struct gpu *g, struct reel_memory m);

/* From here to reel_recorded what is queued goes to a new reel, too; NULL: all
 * of it did not, or is not good. */
void reel_record(struct gpu *g);
void reel_record_look(struct gpu *g, struct reel_memory m,
                      const struct reel_look *k);
/* What gpu_loop has just queued. */
void reel_record_loop(struct gpu *g, const int32_t *again, loop_turn turn);
struct reel *reel_recorded(struct gpu *g, bool good);
#ifdef __CUDACC__
/* Whether a failure is the reel's alone. */
bool reel_spoils(struct gpu *g);
/* device.cu's: until *mark is next, which the device writes. */
void gpu_await(struct gpu *g, const int64_t *mark, int64_t next);
#endif

void reel_play(struct gpu *g, struct reel *r);
void reel_drop(struct gpu *g, struct reel *r);
/* Until look k is shown, or the device has failed. */
void reel_await(struct gpu *g, struct reel_memory m, int look);

#endif
