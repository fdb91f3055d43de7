/* SPDX-License-Identifier: Apache-2.0 */
/* The passes of the BVTT's front: two ranks of two threads, and two tiles, of which each
 * rank has one. Pairs go from one stream to the other and back. The last pass is that
 * which tests no new pair.
 * code gpu/broad/front.cu settle: group_sync<GRID> group_sync<GRID>
 * code gpu/broad/front.cu front_kernel: group_sync<GRID>
 * code gpu/broad/passes.cuh place_tiles: __syncthreads
 */
#define THREADS 4
#define BLOCK 2
#define SCAN 0 /* [BLOCKS][BLOCK] the memory of block_scan */
#define GLOBAL 4
#define SUM 4   /* [2] of tiles */
#define PLACE 6 /* [2] */
#define TESTED 8
#define PAIR 9 /* [2][THREADS] two streams; a pair's action is its thread's own */
#define CELLS 17
#include "memory.pml"

#define block_sync_of_scan(t) block_sync(t)

/* As scan.pml shows, the counts of all threads come together. */
inline scan(t)
{
    block_sync_of_scan(t);
    d_step { store(t, SCAN + t, 0) };
    block_sync_of_scan(t);
    d_step { load_all(t, SCAN + t / BLOCK * BLOCK, 2) }
}

/* Of each pass two pairs of tile 0 are new, up to the third pass. */
inline count_tile(t)
{
    d_step
    {
        load(t, PAIR + from * THREADS + t);
        if
        :: t > 0 -> load(t, PAIR + from * THREADS + t - 1) /* is it the pair before? */
        :: else
        fi
    };
    scan(t);
    d_step
    {
        if
        :: t % BLOCK == 0 ->
            store(t, SUM + t / BLOCK, 2);
            if
            :: pass < 2 -> atomic_of(t, TESTED, old, value[TESTED] + 1)
            :: else
            fi
        :: else
        fi
    }
}

inline place_tiles(t)
{
    d_step { load_all(t, SUM, 2) };
    scan(t);
    d_step
    {
        if
        :: t % BLOCK == 1 -> store(t, PLACE + t / BLOCK, 0)
        :: else
        fi
    };
    block_sync(t)
}

/* A tile's pairs go to any place of the other stream. */
inline emit_successors(t)
{
    d_step
    {
        load(t, PLACE + t / BLOCK);
        load(t, PAIR + from * THREADS + t)
    };
    scan(t);
    d_step { store(t, PAIR + (1 - from) * THREADS + (t + 1) % THREADS, 0) }
}

inline settle(t)
{
    before = 9;
    do
    :: true ->
        count_tile(t);
        cluster_sync(t);
        d_step
        {
            load(t, TESTED);
            tested = value[TESTED]
        };
        if
        :: tested == before -> break
        :: else
        fi;
        before = tested;
        place_tiles(t);
        emit_successors(t);
        from = 1 - from;
        cluster_sync(t);
        pass++
    od
}

inline front_kernel(t)
{
    d_step { store(t, PAIR + (t + 2) % THREADS, 0) };
    cluster_sync(t);
    settle(t);
    /* the pairs go back to the first stream */
    true;
    d_step
    {
        if
        :: from != 0 ->
            load(t, PAIR + THREADS + t);
            store(t, PAIR + t, 0)
        :: else
        fi
    }
}

proctype thread(byte t)
{
    bit turn, from;
    byte old, pass, tested, before;
    front_kernel(t);
    assert(pass == 2)
}

START
