/* SPDX-License-Identifier: Apache-2.0 */
/* A reel is a list of calls on the host. gpu/run/reel.cuh */
#include "gpu/run/reel.cuh"

struct reel {
    struct emulate_op *first;
};

/* Of what is recorded, or of the turn of a loop meanwhile: the list's end. */
struct gpu_reel {
    struct emulate_op *first, **end;
    bool ended; /* of what is played: nothing is left to do */
};

void emulate_keep(struct gpu *g, struct emulate_op *op)
{
    *g->reel->end = op;
    g->reel->end = &op->next;
}

template <class F> static void keep(struct gpu *g, F f)
{
    emulate_keep(g, new emulate_kept<F>(f));
}

bool reel_open(struct gpu *g, struct reel_memory *m)
{
    int shown = (int)REEL_LOOKS * SLOT + (int)TAPE_TOLD;
    int kept = (int)REEL_LOOKS * (int)GPU_ALL_WORDS + (int)TAPE_TOLD + 1;
    g->reel = (struct gpu_reel *)arena_take(&g->host, ARENA_OTHER, 1,
                                            sizeof *g->reel);
    m->kept = (int64_t *)gpu_take(g, ARENA_SCRATCH, kept, sizeof *m->kept);
    m->shown =
        (int64_t *)arena_take(&g->host, ARENA_OTHER, shown, sizeof *m->shown);
    return g->reel && m->kept && m->shown;
}

void reel_close(struct gpu *, struct reel_memory) {}

void reel_record(struct gpu *g)
{
    g->reel->first = NULL;
    g->reel->end = &g->reel->first;
}

void reel_record_look(struct gpu *g, struct reel_memory m,
                      const struct reel_look *look)
{
    struct reel_look k = *look;
    keep(g, [=] {
        int64_t *seen = shown_of(m, k.number), *kept = kept_of(m, k.number);
        int64_t *verdict = told_of(m) + TAPE_TOLD;
        memcpy(kept, g->words, GPU_ALL_WORDS * sizeof *kept);
        memcpy(seen, g->words, GPU_ALL_WORDS * sizeof *seen);
        if (k.clear)
            memset(g->words, 0, GPU_ALL_WORDS * sizeof *g->words);
        seen[VERDICT] = *verdict = judge(&k, kept, told_of(m));
        seen[MARK] = 1;
        g->reel->ended = k.fence && *verdict != GOES_ON;
    });
}

static void run(struct gpu *g, struct emulate_op *op)
{
    for (; op && !g->reel->ended; op = op->next)
        op->run();
}

static void forget(struct emulate_op *op)
{
    for (struct emulate_op *next; op; op = next) {
        next = op->next;
        delete op;
    }
}

/* A loop's turn, and how often it is to be run. */
struct loop_op : emulate_op {
    struct gpu *g;
    const int32_t *again; /* NULL: once */
    struct emulate_op *turn = NULL;
    loop_op(struct gpu *g, const int32_t *again) : g(g), again(again) {}
    ~loop_op() override { forget(turn); }
    void run() override
    {
        if (!again)
            ::run(g, turn);
        while (again && *again && !emulate_lost(false))
            ::run(g, turn);
    }
};

void reel_record_loop(struct gpu *g, const int32_t *again, loop_turn turn)
{
    struct loop_op *loop = new loop_op(g, again);
    struct emulate_op **end = g->reel->end;
    g->reel->end = &loop->turn;
    g->tape = TAPE_KEEPS;
    turn.run(turn.with);
    g->tape = TAPE_RECORDS;
    g->reel->end = end;
    emulate_keep(g, loop);
}

struct reel *reel_recorded(struct gpu *g, bool good)
{
    struct reel *r = NULL;
    if (good)
        r = (struct reel *)arena_take(&g->host, ARENA_OTHER, 1, sizeof *r);
    if (r)
        r->first = g->reel->first;
    else
        forget(g->reel->first);
    return r;
}

void reel_play(struct gpu *g, struct reel *r)
{
    g->reel->ended = false;
    run(g, r->first);
}

void reel_drop(struct gpu *g, struct reel *r)
{
    if (!r)
        return;
    forget(r->first);
    arena_give(&g->host, r);
}

void reel_await(struct gpu *g, struct reel_memory, int)
{
    gpu_status(g);
}
