/* SPDX-License-Identifier: Apache-2.0 */
/* The block that ends last sees what all blocks wrote, and there is one: for sums, whose
 * first threads write for their block (grid_sums), or all of them (item_sum).
 * code gpu/base/cluster.cuh ends_last: __threadfence last= atomicAdd last __syncthreads __threadfence last
 * code gpu/base/sum.cuh item_sum: __syncthreads
 */
#define THREADS 4
#define BLOCK 2
#define LAST 0 /* [BLOCKS], shared */
#define GLOBAL 2
#define ITEM 2 /* [THREADS] */
#define TICKET 6
#define CELLS 7
#include "memory.pml"

#define fence_late(t) fence(t)
#define atomic_early(t, c, old, x) atomic_of(t, c, old, x)
bit by_item;
byte lasts, done;

inline ends_last(t)
{
    if
    :: t % BLOCK == 0 ->
        if
        :: FAULT(ticket_before_fence) ->
            d_step { atomic_early(t, TICKET, old, value[TICKET] + 1) };
            fence_late(t)
        :: else ->
            fence(t);
            d_step { atomic_of(t, TICKET, old, value[TICKET] + 1) }
        fi;
        d_step
        {
            store(t, LAST + t / BLOCK, old == BLOCKS - 1 + FAULT(one_more));
            if
            :: old == BLOCKS - 1 -> value[TICKET] = 0
            :: else
            fi
        }
    :: else
    fi;
    block_sync(t);
    fence(t);
    d_step
    {
        load(t, LAST + t / BLOCK);
        last = value[LAST + t / BLOCK]
    }
}

/* All threads have written; or only the block's first one, which draws the ticket. */
inline item_sum(t)
{
    d_step { store(t, ITEM + t, BIT(t)) };
    block_sync(t);
    ends_last(t)
}

inline put_sums(t)
{
    d_step
    {
        if
        :: t % BLOCK == 0 -> store(t, ITEM + t, BIT(t) + BIT(t + 1))
        :: else
        fi
    }
}

proctype thread(byte t)
{
    bit turn, last;
    byte old, k, sum;
    if
    :: by_item -> item_sum(t)
    :: else ->
        put_sums(t);
        ends_last(t)
    fi;
    d_step
    {
        if
        :: last ->
            do
            :: k < THREADS ->
                load(t, ITEM + k);
                sum = sum + value[ITEM + k];
                k = k + (by_item -> 1 : BLOCK)
            :: else -> break
            od;
            assert(sum == BIT(THREADS) - 1);
            lasts++
        :: else
        fi;
        done++;
        assert(done < THREADS || (lasts == BLOCK && value[TICKET] == 0))
    }
}

init
{
    begin_memory();
    atomic
    {
        if
        :: by_item = 0
        :: by_item = 1
        fi;
        run thread(0);
        run thread(1);
        run thread(2);
        run thread(3)
    }
}
