/* SPDX-License-Identifier: Apache-2.0 */
/* When a step is put on a tape, when one is played, and how the host follows
 * it. gpu/run/tape.cuh */
#include "gpu/run/reel.cuh"

#include <stdio.h>

/* Tapes that are kept; launches and looks of one; what is recalled in a step,
 * and numbers that choices were made by. */
enum { TAPES = 16, OPS = 512, RECALLED = 32, NUMBERS = 32 };
/* A key is recorded when it has come up so often, as that takes as long as ten
 * plays save; twice as often each time that it was in vain, or the tape had too
 * little room. A tape that a fence ended while it was recorded is played so
 * often. */
#ifdef __CUDACC__
enum { PATIENCE = 6, MOST_PATIENCE = 24, SHORT_PLAYS = 64 };
#else
enum { PATIENCE = 2, MOST_PATIENCE = 16, SHORT_PLAYS = 64 };
#endif

/* One tape; its key lies behind it. */
struct tape {
    struct tape *next;
    struct reel *reel; /* NULL: not recorded yet */
    size_t n;
    int block, ranks;
    int64_t changes, used;
    int seen;   /* how often the key has come up */
    int plays;  /* that are left of a short one, else 0 */
    bool whole; /* it goes on to the step's end */
    int ops;    /* launches and looks */
    const void *op[OPS];
    int64_t number[NUMBERS]; /* gpu_recorded's */
};

struct gpu_tapes {
    bool absent, loose; /* loose: one that was left may write looks still */
    int patience;
    struct tape *first, *now;
    int count;
    int64_t begun;
    struct reel_memory memory;
    struct gpu_played played;

    /* Of the tape under way. */
    int op, looks, told, recalled, numbers;
    bool spoilt, departs; /* of a recorded one: worthless; ended at a look */
    bool pending;         /* the last look is not recorded yet */
    bool open;            /* no fence is behind it */
    struct reel_look look;
    struct {
        const void *who;
        const int64_t *at;
    } recall[RECALLED];
};

/* ---- Tapes that are kept ---- */

static void drop(struct gpu *g, struct tape **at)
{
    struct tape *t = *at;
    *at = t->next;
    g->tapes->count--;
    reel_drop(g, t->reel);
    arena_give(&g->host, t);
}

/* Those that hold no more go, and the oldest of too many. */
static void clean(struct gpu *g)
{
    struct gpu_tapes *l = g->tapes;
    struct tape **oldest = &l->first;
    for (struct tape **at = &l->first; *at;)
        if ((*at)->changes != g->changes)
            drop(g, at);
        else
            at = &(*at)->next;
    if (l->count < TAPES)
        return;
    for (struct tape **at = &l->first; *at; at = &(*at)->next)
        if ((*at)->used < (*oldest)->used)
            oldest = at;
    drop(g, oldest);
}

static bool same(const struct tape *t, const struct gpu *g, struct tape_key key)
{
    return t->changes == g->changes && t->block == g->block &&
           t->ranks == g->ranks && t->n == key.n &&
           !memcmp(t + 1, key.bytes, key.n);
}

/* That of the key, perhaps new; NULL: there is no memory. */
static struct tape *find(struct gpu *g, struct tape_key key)
{
    struct tape *t = g->tapes->first;
    while (t && !same(t, g, key))
        t = t->next;
    if (t)
        return t;
    clean(g);
    t = (struct tape *)arena_take(&g->host, ARENA_OTHER,
                                  (int64_t)(sizeof *t + key.n), 1);
    if (!t)
        return NULL;
    t->block = g->block;
    t->ranks = g->ranks;
    t->changes = g->changes;
    t->n = key.n;
    memcpy(t + 1, key.bytes, key.n);
    t->next = g->tapes->first;
    g->tapes->first = t;
    g->tapes->count++;
    return t;
}

static bool open(struct gpu *g)
{
    struct gpu_tapes *l = g->tapes;
    if (g->hosted[0] || g->hosted[1] || g->failed || (l && l->absent))
        return false;
    if (l)
        return true;
    l = (struct gpu_tapes *)arena_take(&g->host, ARENA_OTHER, 1, sizeof *l);
    if (!l)
        return false;
    g->tapes = l;
    l->patience = PATIENCE;
    l->absent = !reel_open(g, &l->memory);
    return !l->absent;
}

void gpu_tapes_close(struct gpu *g)
{
    struct gpu_tapes *l = g->tapes;
    if (!l)
        return;
    while (l->first)
        drop(g, &l->first);
    reel_close(g, l->memory);
}

/* ---- Recording ---- */

/* The last look, once all is known that is expected of it. */
static void flush(struct gpu *g)
{
    struct gpu_tapes *l = g->tapes;
    if (l->pending)
        reel_record_look(g, l->memory, &l->look);
    l->pending = false;
}

static void note_op(struct gpu_tapes *l, const void *what)
{
    if (l->op < OPS)
        l->now->op[l->op++] = what;
    else
        l->spoilt = true;
}

/* In vain: later again. */
static void lose_patience(struct gpu_tapes *l, struct tape *t)
{
    l->patience = l->patience < MOST_PATIENCE ? 2 * l->patience : l->patience;
    t->seen = 0;
}

static void finish(struct gpu *g)
{
    struct gpu_tapes *l = g->tapes;
    struct tape *t = l->now;
    flush(g);
    g->tape = TAPE_OFF;
    g->found = NULL;
    t->reel = reel_recorded(g, !l->spoilt && t->changes == g->changes);
    t->ops = l->op;
    t->plays = l->departs ? (int)SHORT_PLAYS : 0;
    t->whole = false;
    if (!t->reel && t->changes == g->changes) /* else it has grown */
        lose_patience(l, t);
}

void gpu_tape_spoil(struct gpu *g)
{
    if (g->tape != TAPE_RECORDS)
        return;
    g->tapes->spoilt = true;
    finish(g);
}

void gpu_fence(struct gpu *g)
{
    struct gpu_tapes *l = g->tapes;
    if (g->tape != TAPE_RECORDS)
        return;
    l->look.fence = l->pending;
    l->open = false;
    if (l->pending)
        flush(g);
    else
        finish(g);
}

void gpu_once(struct gpu *g)
{
    if (g->tape == TAPE_RECORDS && g->tapes->open)
        gpu_fence(g);
}

/* ---- A step ---- */

static void play(struct gpu *g)
{
    struct gpu_tapes *l = g->tapes;
    if (l->loose)
        gpu_wait(g);
    l->loose = false;
    for (int k = 0; k < REEL_LOOKS; k++)
        shown_of(l->memory, k)[MARK] = 0;
    g->tape = TAPE_PLAYS;
    l->played.begun++;
    reel_play(g, l->now->reel);
}

static void record(struct gpu *g)
{
    reel_record(g);
    g->tape = TAPE_RECORDS;
}

/* Words are as a step's first stage finds them, whatever was before. */
static void wipe_words(struct gpu *g)
{
    if (!g->clean[0] || !g->clean[1])
        gpu_clear(g, g->words, GPU_ALL_WORDS * sizeof *g->words);
    g->clean[0] = g->clean[1] = true;
}

/* Thread t owns thing t that is told. */
static __global__ void __launch_bounds__(TAPE_TOLD)
    tape_tell_kernel(const int64_t *told, int64_t *there)
{
    there[threadIdx.x] = told[threadIdx.x];
    if (threadIdx.x == 0)
        there[TAPE_TOLD] = GOES_ON;
}

void gpu_tape_begin(struct gpu *g, struct tape_key key, const int64_t *told,
                    int n)
{
    if (!open(g))
        return;
    struct gpu_tapes *l = g->tapes;
    struct tape *t = l->now = find(g, key);
    if (!t)
        return;
    t->used = ++l->begun;
    if (!t->reel && ++t->seen < l->patience)
        return;
    l->op = l->looks = l->told = l->recalled = l->numbers = 0;
    l->spoilt = l->departs = l->pending = l->open = false;
    int64_t *tell = shown_of(l->memory, REEL_LOOKS);
    memcpy(tell, told, (size_t)n * sizeof *told);
    tell[TAPE_TOLD - 1] = g->falters - 1;
    wipe_words(g);
    if (t->reel)
        play(g);
    else
        record(g);
    LAUNCH_BLOCKS(g, 1, TAPE_TOLD, tape_tell_kernel, tell, told_of(l->memory));
}

static void unreel(struct gpu *g, struct tape *t)
{
    reel_drop(g, t->reel);
    t->reel = NULL;
    t->plays = 0;
}

/* What was recorded while a step went another way is not played for ever. */
static void leave(struct gpu *g)
{
    struct gpu_tapes *l = g->tapes;
    struct tape *t = l->now;
    g->tape = TAPE_OFF;
    l->patience -= l->patience > PATIENCE;
    if (t->plays > 0 && --t->plays == 0)
        unreel(g, t);
}

/* The tape was of other launches than the host's: an error of ours. */
static void confess(struct gpu *g)
{
    size_t n = strlen(g->name);
    leave(g);
    if (!g->failed)
        snprintf(g->name + n, sizeof g->name - n, ": a tape is not its step's");
    g->failed = g->failed ? g->failed : (int)DRAPE_EDEVICE;
}

/* All of it was done. */
static void complete(struct gpu *g)
{
    g->tapes->played.whole += g->tapes->now->whole;
    leave(g);
}

struct gpu_played gpu_played(const struct gpu *g)
{
    struct gpu_played none = {0, 0};
    return g->tapes ? g->tapes->played : none;
}

/* Whether the next launch or look is the tape's. */
static bool plays_next(struct gpu *g, const void *what)
{
    struct gpu_tapes *l = g->tapes;
    if (l->op == l->now->ops) {
        complete(g);
        return false;
    }
    if (l->now->op[l->op++] != what)
        confess(g);
    return true;
}

int gpu_tape_queues(struct gpu *g, const void *what)
{
    struct gpu_tapes *l = g->tapes;
    if (g->tape == TAPE_PLAYS)
        return plays_next(g, what) ? 0 : 1;
    flush(g);
    note_op(l, what);
    return 2;
}

void gpu_tape_end(struct gpu *g)
{
    if (g->tape == TAPE_RECORDS)
        finish(g);
    else if (g->tape == TAPE_PLAYS && g->tapes->op < g->tapes->now->ops)
        confess(g);
    else if (g->tape == TAPE_PLAYS)
        complete(g);
}

void gpu_tape_done(struct gpu *g)
{
    bool recorded = g->tape == TAPE_RECORDS;
    gpu_tape_end(g);
    if (recorded)
        g->tapes->now->whole = true;
}

/* ---- Looks ---- */

int64_t *gpu_tape_looks(struct gpu *g, bool clear)
{
    struct gpu_tapes *l = g->tapes;
    if (g->tape != TAPE_RECORDS)
        return NULL;
    if (l->looks == REEL_LOOKS) {
        finish(g);
        return NULL;
    }
    flush(g);
    note_op(l, (const void *)gpu_tape_looks);
    l->pending = l->open = true;
    l->look = {l->looks, clear, false, {}};
    return kept_of(l->memory, l->looks++);
}

/* The host goes on by itself behind look k: words are as that left them. */
static void depart(struct gpu *g, int k, bool clear)
{
    struct gpu_tapes *l = g->tapes;
    struct tape *t = l->now;
    bool cramped = shown_of(l->memory, k)[VERDICT] == NO_ROOM;
    size_t bytes = GPU_ALL_WORDS * sizeof *g->words;
    leave(g);
    l->loose = true;
    if (cramped) {
        unreel(g, t);
        lose_patience(l, t);
    }
    if (clear)
        gpu_clear(g, g->words, bytes);
    else
        gpu_copy(g, g->words, kept_of(l->memory, k), bytes);
}

bool gpu_tape_shows(struct gpu *g, bool clear)
{
    struct gpu_tapes *l = g->tapes;
    if (g->tape != TAPE_PLAYS || !plays_next(g, (const void *)gpu_tape_looks))
        return false;
    int k = l->looks++;
    g->seen = shown_of(l->memory, k);
    if (!g->failed)
        reel_await(g, l->memory, k);
    if (!g->failed && g->seen[VERDICT] != GOES_ON)
        depart(g, k, clear);
    else if (l->op == l->now->ops) /* what is next is the host's */
        complete(g);
    return true;
}

const int64_t *gpu_kept(const struct gpu *g, int word)
{
    const struct gpu_tapes *l = g->tapes;
    bool has = g->tape == TAPE_RECORDS && l->looks;
    return has ? kept_of(l->memory, l->looks - 1) + word : NULL;
}

const int64_t *gpu_told(struct gpu *g)
{
    struct gpu_tapes *l = g->tapes;
    return g->tape == TAPE_RECORDS ? told_of(l->memory) + l->told++ : NULL;
}

int64_t gpu_recorded(struct gpu *g, int64_t n)
{
    struct gpu_tapes *l = g->tapes;
    if (g->tape == TAPE_OFF)
        return n;
    if (l->numbers == NUMBERS) {
        l->spoilt = true;
        return n;
    }
    int64_t *number = &l->now->number[l->numbers++];
    return g->tape == TAPE_PLAYS ? *number : (*number = n);
}

static void keep(struct gpu *g, const void *who, const int64_t *at)
{
    struct gpu_tapes *l = g->tapes;
    if (g->tape != TAPE_RECORDS)
        return;
    if (l->recalled < RECALLED)
        l->recall[l->recalled++] = {who, at};
    else
        l->spoilt = true;
}

void gpu_keep(struct gpu *g, const void *who, int word)
{
    keep(g, who, gpu_kept(g, word));
}

void gpu_keep_found(struct gpu *g, const void *who)
{
    keep(g, who, g->found);
}

const int64_t *gpu_recall(const struct gpu *g, const void *who)
{
    const struct gpu_tapes *l = g->tapes;
    if (g->tape != TAPE_RECORDS)
        return NULL;
    for (int k = l->recalled; k-- > 0;)
        if (l->recall[k].who == who)
            return l->recall[k].at;
    return NULL;
}

/* ---- What is expected of the last look ---- */

static void expect(struct gpu *g, struct expect e)
{
    struct gpu_tapes *l = g->tapes;
    if (g->tape != TAPE_RECORDS)
        return;
    int64_t word = g->seen[e.word];
    int64_t value = e.half < 0 ? word : (int32_t)(word >> 32 * e.half);
    l->departs = value < e.least || value > e.most;
    if (l->look.expected.n < REEL_EXPECTED)
        l->look.expected.of[l->look.expected.n++] = e;
    else
        l->spoilt = true;
    if (l->departs) /* at once: what comes may be this stage again */
        finish(g);
}

void gpu_expect(struct gpu *g, int word, int64_t least, int64_t most)
{
    expect(g, {word, -1, false, least, most});
}

void gpu_expect_half(struct gpu *g, int word, int half, int32_t value)
{
    expect(g, {word, half, false, value, value});
}

void gpu_expect_room(struct gpu *g, int word, int64_t cap)
{
    expect(g, {word, -1, true, 0, cap});
}

void gpu_expect_some(struct gpu *g, int word, int64_t cap)
{
    int64_t n = g->seen[word], room = gpu_room(g, n);
    if (n)
        expect(g, {word, -1, true, 1, cap < room ? cap : room});
    else
        gpu_expect(g, word, 0, 0);
}
