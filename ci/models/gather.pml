/* SPDX-License-Identifier: Apache-2.0 */
/* The gather of contacts' impulses: warp o sums number o of each vertex; of a long list
 * by all its lanes. The first warp lists the long ones.
 * code gpu/contact/coulomb.cu coulomb_gather_kernel: n= __syncthreads row atomicAdd longer= __syncthreads n longer row
 */
#define THREADS 4
#define BLOCK 4
#define WARP 2
#define N 0
#define LONGER 1 /* [WARP] */
#define ROW 3    /* [WARPS][WARP] */
#define GLOBAL 7
#define OUT 7 /* [WARP][WARPS] a number of a vertex */
#define CELLS 11
#include "memory.pml"

byte longs; /* the vertices with long lists */

inline sum_by_warp(t)
{
    r = 0;
    do
    :: r < 2 ->
        warp_sync(t);
        d_step { store(t, ROW + t, 1) };
        warp_sync(t);
        d_step
        {
            load(t, ROW + t / WARP * WARP);
            load(t, ROW + t / WARP * WARP + 1)
        };
        r++
    :: else -> break
    od;
    warp_sync(t) /* spare: the next list's first barrier comes before it writes */
}

inline coulomb_gather_kernel(t)
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
    :: !(longs & BIT(t % WARP)) ->
        d_step { store(t, OUT + t % WARP * WARPS + t / WARP, 1) }
    :: else ->
        if
        :: t / WARP == 0 ->
            d_step { atomic_of(t, N, place, value[N] + 1) };
            d_step { store(t, LONGER + place, t % WARP) }
        :: else
        fi
    fi;
    block_sync(t);
    l = 0;
    do
    :: l < value[N] ->
       d_step
       {
           load(t, N);
           load(t, LONGER + l);
           owner = value[LONGER + l]
       };
       sum_by_warp(t);
       d_step
       {
           if
           :: t % WARP == 0 -> store(t, OUT + owner * WARPS + t / WARP, 1)
           :: else
           fi
       };
       l++
    :: else ->
       d_step { load(t, N) };
       break
    od
}

byte ended;
proctype thread(byte t)
{
    bit turn;
    byte place, l, owner, r;
    coulomb_gather_kernel(t);
    true;
    d_step
    {
        ended++;
        assert(ended < THREADS || value[OUT] + value[OUT + 1] + value[OUT + 2] +
               value[OUT + 3] == THREADS)
    }
}

init
{
    begin_memory();
    atomic
    {
        if
        :: longs = 0
        :: longs = 1
        :: longs = 2
        :: longs = 3
        fi;
        run thread(0);
        run thread(1);
        run thread(2);
        run thread(3)
    }
}
