/* SPDX-License-Identifier: Apache-2.0 */
/* The compaction of a block, twice in a row: each kept item has its own place.
 * code gpu/base/compact.cuh block_compact: __syncthreads word= __syncthreads atomicOr word __syncthreads word
 */
#define THREADS 4
#define BLOCK 4
#define LANES 2
#define CELLS 2 /* a word for each warp of two */
#include "memory.pml"

byte kept[2]; /* the threads that keep an item, in each call */

inline popcount(x, n)
{
    n = ((x) & 1) + ((x) >> 1 & 1) + ((x) >> 2 & 1) + ((x) >> 3 & 1)
}

inline block_compact(t, keep)
{
    block_sync(t);
    d_step
    {
        if
        :: t % LANES == 0 -> store(t, t / LANES, 0)
        :: else
        fi
    };
    block_sync(t);
    d_step
    {
        if
        :: keep -> atomic_of(t, t / LANES, old, value[t / LANES] | BIT(t % LANES))
        :: else
        fi
    };
    block_sync(t);
    d_step
    {
        load(t, 0);
        load(t, 1);
        popcount(value[0], n);
        popcount(value[1], total);
        place = (t / LANES > 0 -> n : 0);
        total = total + n;
        popcount(value[t / LANES] & (BIT(t % LANES) - 1), n);
        place = place + n
    }
}

/* Each thread keeps its item or not; which of them do is a mask, for the assertions. */
inline compact(t, call)
{
    atomic
    {
        if
        :: keep = 0
        :: keep = 1
        fi;
        kept[call] = (kept[call] & ~BIT(t)) | keep << t
    };
    block_compact(t, keep);
    d_step
    {
        popcount(kept[call], n);
        assert(total == n);
        popcount(kept[call] & (BIT(t) - 1), n);
        assert(place == n)
    };
    n = 0;
    place = 0;
    total = 0;
    old = 0
}

proctype thread(byte t)
{
    bit turn, keep;
    byte old, n, place, total;
    compact(t, 0);
    compact(t, 1)
}

START
