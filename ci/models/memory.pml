/* SPDX-License-Identifier: Apache-2.0 */
/* What the models of kernels share: threads, barriers, fences and memory whose data
 * races are errors. A model defines THREADS (all of them), BLOCK (of a block; blocks
 * follow one another), WARP (of a warp), CELLS (of memory) and GLOBAL (the first cell in
 * global memory; those before are shared memory), then includes this file.
 *
 * A read must know the last write of its cell, and a write must know the last write
 * and all reads: there must be barriers or fences between them, in each schedule. So
 * no result depends on the schedule, and none on how late a write reaches memory:
 * programs without races behave as if threads took turns (PTX ISA, memory consistency).
 * What an agent knows it passes on at a barrier of its group, and by fences: all
 * fences of a device are in one order, and each knows what those before knew (PTX ISA,
 * Fence-SC). An atomic passes on nothing; atomics of one cell do not race. */
#ifndef WARP
#define WARP THREADS
#endif
#ifndef GLOBAL
#define GLOBAL CELLS
#endif
#define BIT(t) (1 << (t))
#define ORDER BIT(THREADS) /* an agent that knows what fences have passed on */
#define ALL (BIT(THREADS + 1) - 1)
#define BLOCKS (THREADS / BLOCK)
#define WARPS (THREADS / WARP)
#define GROUPS (BLOCKS + WARPS + 1)
#define CLUSTER (GROUPS - 1)

byte value[CELLS];
byte written[CELLS];          /* the agents that know the last write */
byte by_read[CELLS * THREADS]; /* those that know a thread's last read */
byte by_atom[CELLS * THREADS]; /* and its last atomic */
byte arrived[GROUPS];         /* threads at a barrier */
bit phase[GROUPS];
byte planted; /* the fault that this run plants; 0: none */
hidden short c_, all_, end_, g_, k_; /* of the code in C, and of load_all */

/* What C computes for a cell c_ or a group g_. */
c_code {
    static int known_reads(const uchar *by)
    {
        int all = ALL;
        for (int k = 0; k < THREADS; k++)
            all &= by[c_ * THREADS + k];
        return all;
    }

    static void forget(uchar *by)
    {
        for (int k = 0; k < THREADS; k++)
            by[c_ * THREADS + k] = ALL;
    }

    static void meet(uchar *by, int from, int end)
    {
        for (int k = from; k < end; k++)
            by[k] |= by[k] & g_ ? g_ : 0;
    }
}

inline begin_memory()
{
    c_code {
        now.planted = getenv("PLANT") ? atoi(getenv("PLANT")) : 0;
        memset(now.written, ALL, sizeof now.written);
        memset(now.by_read, ALL, sizeof now.by_read);
        memset(now.by_atom, ALL, sizeof now.by_atom);
    }
}

/* A plain read of cell c by thread t; its value is value[c]. Accesses stand in a d_step,
 * with all those of a thread up to its next barrier, fence or atomic: races between them
 * are found in any order, so that others need not be tried. */
inline load(me, at_)
{
    assert(written[at_] & BIT(me));
    c_ = at_;
    c_code { all_ = known_reads(now.by_atom); };
    assert(all_ & BIT(me));
    by_read[(at_) * THREADS + me] = BIT(me)
}

inline store(me, at_, set_)
{
    assert(written[at_] & BIT(me));
    c_ = at_;
    c_code { all_ = known_reads(now.by_atom); };
    assert(all_ & BIT(me));
    c_code { all_ = known_reads(now.by_read); };
    assert(all_ & BIT(me));
    c_code { forget(now.by_read); forget(now.by_atom); };
    written[at_] = BIT(me);
    value[at_] = set_
}

/* An atomic: sets old and value[c]. atomic_same: one of several writes, which are of the
 * same value. */
inline atomic_of(me, at_, old_, set_)
{
    assert(written[at_] & BIT(me));
    c_ = at_;
    c_code { all_ = known_reads(now.by_read); };
    assert(all_ & BIT(me));
    by_atom[(at_) * THREADS + me] = BIT(me);
    old_ = value[at_];
    value[at_] = set_
}

#define atomic_same(me, at_, old_, set_) atomic_of(me, at_, old_, set_)

/* The agents of a group tell each other what they know of the cells before `end`. */
inline meet(group, end)
{
    g_ = group;
    end_ = end;
    c_code {
        meet(now.written, 0, end_);
        meet(now.by_read, 0, end_ * THREADS);
        meet(now.by_atom, 0, end_ * THREADS);
    }
}

/* A barrier of `size` threads. turn: a bit of the thread's own. */
inline barrier_of(group, size, members, end)
{
    d_step
    {
        turn = phase[group];
        arrived[group]++;
        if
        :: arrived[group] == size ->
            meet(members, end);
            arrived[group] = 0;
            phase[group] = 1 - phase[group]
        :: else
        fi
    };
    phase[group] != turn;
    turn = 0
}

#define OF_BLOCK(t) ((BIT(BLOCK) - 1) << ((t) / BLOCK * BLOCK))
#define OF_WARP(t) ((BIT(WARP) - 1) << ((t) / WARP * WARP))
#define block_sync(t) barrier_of((t) / BLOCK, BLOCK, OF_BLOCK(t), CELLS)
#define warp_sync(t) barrier_of(BLOCKS + (t) / WARP, WARP, OF_WARP(t), CELLS)
#define cluster_sync(t) barrier_of(CLUSTER, THREADS, BIT(THREADS) - 1, CELLS)
#define cluster_sync_shared(t) barrier_of(CLUSTER, THREADS, BIT(THREADS) - 1, GLOBAL)

/* Barriers of a cluster, or of the own block where `alone`. */
inline cluster_sync_unless(t, alone)
{
    if
    :: alone -> block_sync(t)
    :: else -> cluster_sync(t)
    fi
}

inline cluster_sync_shared_unless(t, alone)
{
    if
    :: alone -> block_sync(t)
    :: else -> cluster_sync_shared(t)
    fi
}

#define fence(t)                                                                       \
    d_step { meet(BIT(t) | ORDER, CELLS) }

/* Runs `thread` THREADS times. */
#define START                                                                          \
    init                                                                               \
    {                                                                                  \
        byte n_;                                                                       \
        begin_memory();                                                                \
        atomic                                                                         \
        {                                                                              \
            do                                                                         \
            :: n_ < THREADS -> run thread(n_); n_++                                    \
            :: else -> break                                                           \
            od                                                                         \
        }                                                                              \
    }

/* Thread t reads n cells. */
inline load_all(t, from, n)
{
    k_ = from;
    do
    :: k_ < (from) + (n) ->
        load(t, k_);
        k_++
    :: else -> break
    od;
    k_ = 0
}
