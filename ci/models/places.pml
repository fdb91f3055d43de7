/* SPDX-License-Identifier: Apache-2.0 */
/* The block that ends last turns the counts of all blocks into places: two blocks of two
 * threads, each with a part of a stream that it compacts first, as close_kernel does.
 * code gpu/contact/proximity.cu close_kernel: __syncthreads __syncthreads __syncthreads
 */
#define THREADS 4
#define BLOCK 2
#define LAST 0 /* [BLOCKS] */
#define SCAN 2 /* [BLOCKS][BLOCK] the memory of block_scan */
#define GLOBAL 6
#define BASE 6 /* [BLOCKS + 1] */
#define TICKET 9
#define AT 10 /* [BLOCKS][4] two rounds of candidates, read and then written */
#define CELLS 18
#include "memory.pml"

#define block_sync_of_compact(t) block_sync(t)
#define fence_of_ends_last(t) fence(t)
#define block_sync_of_ends_last(t) block_sync(t)
#define block_sync_of_scan(t) block_sync(t)

/* As last.pml shows. */
inline ends_last(t)
{
    if
    :: t % BLOCK == 0 ->
        fence_of_ends_last(t);
        d_step { atomic_of(t, TICKET, old, value[TICKET] + 1) };
        d_step { store(t, LAST + t / BLOCK, old == BLOCKS - 1) }
    :: else
    fi;
    block_sync_of_ends_last(t);
    fence_of_ends_last(t);
    d_step { load(t, LAST + t / BLOCK) }
}

/* As scan.pml shows. Thread t scans two counts. */
inline scan_blocks(t)
{
    d_step
    {
        load(t, BASE + 2 * (t % BLOCK));
        if
        :: t % BLOCK == 0 -> load(t, BASE + 1)
        :: else
        fi
    };
    block_sync_of_scan(t);
    d_step { store(t, SCAN + t, 0) };
    block_sync_of_scan(t);
    d_step
    {
        load_all(t, SCAN + t / BLOCK * BLOCK, 2);
        if
        :: t % BLOCK == 0 ->
            store(t, BASE, 0);
            store(t, BASE + 1, 1)
        :: else -> store(t, BASE + 2, 2)
        fi
    }
}

inline close_kernel(t)
{
    round = 0;
    do
    :: round < 2 ->
        d_step { load(t, AT + 4 * (t / BLOCK) + 2 * round + t % BLOCK) };
        block_sync_of_compact(t);
        if
        :: t % BLOCK == 0 ->
            d_step { store(t, AT + 4 * (t / BLOCK) + round, 0) }
        :: else
        fi;
        round++
    :: else -> break
    od;
    true;
    d_step
    {
        if
        :: t % BLOCK == 0 -> store(t, BASE + t / BLOCK, 1)
        :: else
        fi
    };
    block_sync(t); /* spare: ends_last uses other memory */
    ends_last(t);
    if
    :: value[LAST + t / BLOCK] ->
        d_step
        {
            if
            :: t % BLOCK == 0 -> store(t, BASE + BLOCKS, 0)
            :: else
            fi
        };
        block_sync(t);
        scan_blocks(t);
        block_sync(t);
        d_step
        {
            if
            :: t % BLOCK == 0 ->
                load(t, BASE + BLOCKS);
                assert(value[BASE + BLOCKS] == 2)
            :: else
            fi
        }
    :: else
    fi
}

proctype thread(byte t)
{
    bit turn;
    byte old, round;
    close_kernel(t)
}

START
