/* SPDX-License-Identifier: Apache-2.0 */
/* The maximum of a block by halves, as block_join joins bounds; then two blocks lower or
 * raise one word. A stale read of the word is smaller, which costs an atomic.
 * code gpu/base/largest.cuh block_largest: a= __syncthreads a= a
 * code gpu/broad/extent.cu block_join: all= __syncthreads all= all
 */
#define THREADS 4
#define BLOCK 4
#define CELLS 4
#include "memory.pml"

inline halve(t)
{
    d_step
    {
        if
        :: t < half ->
            load(t, t);
            load(t, t + half);
            most = value[t + half];
            most = (value[t] < most -> most : value[t]);
            store(t, t, most)
        :: else
        fi
    };
    half = half / 2
}

inline block_largest(t, mine)
{
    d_step { store(t, t, mine) };
    half = BLOCK / 2;
    do
    :: half > 0 ->
        block_sync(t);
        halve(t)
    :: else -> break
    od
}

inline block_join(t, mine)
{
    d_step { store(t, t, mine) };
    half = BLOCK / 2;
    do
    :: half > 0 ->
        block_sync(t);
        halve(t)
    :: else -> break
    od
}

bit joins;
proctype thread(byte t)
{
    bit turn;
    byte half, most;
    if
    :: joins -> block_join(t, (t * 3 + 1) % 5)
    :: else -> block_largest(t, (t * 3 + 1) % 5)
    fi;
    if
    :: t == 0 -> assert(value[0] == 4)
    :: else
    fi
}

init
{
    begin_memory();
    atomic
    {
        if
        :: joins = 0
        :: joins = 1
        fi;
        run thread(0);
        run thread(1);
        run thread(2);
        run thread(3)
    }
}
