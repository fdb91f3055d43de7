/* SPDX-License-Identifier: Apache-2.0 */
/* The passes of a walk: two ranks of two threads, and two tiles, of which each rank has
 * one. All ranks see whether a child is deeper, and make another pass; then they test
 * triangles.
 * code gpu/broad/walk.cu finish: group_sync<GRID>
 * code gpu/broad/walk.cu go_down: group_sync<GRID>
 */
#define THREADS 4
#define BLOCK 2
#define GLOBAL 0
#define SUM 0   /* [2] of tiles */
#define PLACE 2 /* [2] */
#define DEEPER 4
#define CHILD 5 /* [THREADS] masks of children */
#define PAIR 9 /* [3][THREADS] two streams of pairs, and the triangles */
#define CELLS 21
#include "memory.pml"

#define block_sync_of_scan(t) block_sync(t)

/* Of a tile, each thread an item: writes masks and sums, and counts what is deeper. */
inline test(t, deep)
{
    d_step
    {
        load(t, PAIR + from * THREADS + t);
        store(t, CHILD + t, 0)
    };
    block_sync_of_scan(t);
    d_step
    {
        if
        :: t % BLOCK == 0 ->
            store(t, SUM + t / BLOCK, 0);
            if
            :: deep -> atomic_of(t, DEEPER, old, value[DEEPER] + 1)
            :: else
            fi
        :: else
        fi
    }
}

/* Places of the own tile, from the sums of all; then the outputs. */
inline finish(t, to)
{
    cluster_sync(t);
    d_step { load_all(t, SUM, 2) };
    block_sync_of_scan(t);
    d_step
    {
        if
        :: t % BLOCK == 1 -> store(t, PLACE + t / BLOCK, 0)
        :: else
        fi
    };
    block_sync_of_scan(t);
    d_step
    {
        load_all(t, CHILD + t / BLOCK * BLOCK, 2);
        load(t, PLACE + t / BLOCK);
        load(t, PAIR + from * THREADS + t);
        store(t, PAIR + (to) * THREADS + (t + 1) % THREADS, 0)
    }
}

inline go_down(t)
{
    do
    :: !last ->
        test(t, pass == 0);
        finish(t, 1 - from);
        d_step
        {
            load(t, DEEPER);
            last = value[DEEPER] == deeper;
            deeper = value[DEEPER]
        };
        cluster_sync(t);
        from = 1 - from;
        pass++
    :: else -> break
    od
}

proctype thread(byte t)
{
    bit turn, from, last;
    byte old, pass, deeper;
    go_down(t);
    test(t, false);
    finish(t, 2);
    assert(pass == 2)
}

START
