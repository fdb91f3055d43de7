/* SPDX-License-Identifier: Apache-2.0 */
/* Sums of lists: a thread sums a short one; the block lists the long ones, and a warp
 * sums each, row by row. Each list is summed once, whoever's it is.
 * code gpu/contact/lists.cuh sum_list: n= __syncthreads atomicAdd longer= __syncthreads n longer row
 * code gpu/contact/lists.cuh sum_by_warp: __syncwarp __syncwarp __syncwarp lane_value
 */
#define THREADS 4
#define BLOCK 4
#define WARP 2
#define N 0
#define LONGER 1 /* [THREADS] */
#define ROW 5    /* [WARPS][WARP] */
#define OUT 9    /* [THREADS] */
#define GLOBAL 9
#define CELLS 13
#include "memory.pml"

byte longs; /* the threads whose lists are long */
byte done;

/* Two rows of a long list, which has a number for each lane. */
inline sum_by_warp(t, owner)
{
    r = 0;
    do
    :: r < 2 ->
        warp_sync(t);
        d_step { store(t, ROW + t, owner + r) };
        warp_sync(t);
        d_step
        {
            k = 0;
            do
            :: k < WARP ->
                load(t, ROW + t / WARP * WARP + k);
                assert(value[ROW + t / WARP * WARP + k] == owner + r);
                k++
            :: else -> break
            od;
            k = 0
        };
        r++
    :: else -> break
    od;
    warp_sync(t) /* spare: the next list's first barrier comes before it writes */
}

inline sum_list(t)
{
    d_step
    {
        if
        :: t == 0 -> store(t, N, 0)
        :: else
        fi
    };
    block_sync(t);
    if
    :: longs & BIT(t) ->
       d_step { atomic_of(t, N, place, value[N] + 1) };
       d_step { store(t, LONGER + place, t) }
    :: else -> d_step { store(t, OUT + t, 1); done = done | BIT(t) }
    fi;
    block_sync(t);
    l = t / WARP;
    do
    :: l < value[N] ->
       d_step
       {
           load(t, N);
           load(t, LONGER + l);
           owner = value[LONGER + l]
       };
       sum_by_warp(t, owner);
       d_step
       {
           if
           :: t % WARP == 0 ->
               store(t, OUT + owner, 1);
               assert(!(done & BIT(owner)));
               done = done | BIT(owner)
           :: else
           fi
       };
       l = l + WARPS
    :: else ->
       d_step { load(t, N) };
       break
    od
}

byte ended;
proctype thread(byte t)
{
    bit turn;
    byte place, l, owner, r, k;
    sum_list(t);
    true;
    d_step
    {
        ended++;
        assert(ended < THREADS || done == BIT(THREADS) - 1)
    }
}

init
{
    begin_memory();
    atomic
    {
        if
        :: longs = 0
        :: longs = 4
        :: longs = 9
        :: longs = 7
        fi;
        run thread(0);
        run thread(1);
        run thread(2);
        run thread(3)
    }
}
