/* SPDX-License-Identifier: Apache-2.0 */
/* The operators of small grids, made by one cluster: two ranks of a thread each, and
 * four grids of two particles. Each pass clears the marks of the grid after the next and
 * then sets them.
 * code gpu/solve/coarsen.cu coarsen_chain_kernel: cluster_sync(false) cluster_sync(false)
 */
#define THREADS 2
#define BLOCK 1
#define GLOBAL 0
#define GRIDS 4
#define RULE 0   /* [GRIDS][2] marks, then rules */
#define BLOCKS_ 8 /* [GRIDS][2] blocks and excess */
#define CELLS 16
#include "memory.pml"

/* Thread t owns particle t of each grid. Blocks of grid k read those of grid k - 1 and
 * the marks of grid k; rules of grid k read those of k - 1 and the blocks of k. */
inline coarsen_chain_kernel(t)
{
    d_step { store(t, RULE + 2 + t, 1) };
    k = 1;
    do
    :: k <= GRIDS ->
        cluster_sync(t);
        d_step
        {
            if
            :: k < GRIDS ->
                load_all(t, BLOCKS_ + 2 * (k - 1), 2);
                load_all(t, RULE + 2 * (k - 1), 2);
                load(t, RULE + 2 * k + t);
                store(t, BLOCKS_ + 2 * k + t, 0)
            :: else -> load_all(t, BLOCKS_ + 2 * (k - 1), 2) /* the last factors */
            fi
        };
        if
        :: k == GRIDS -> break
        :: else
        fi;
        d_step
        {
            if
            :: k + 1 < GRIDS -> store(t, RULE + 2 * (k + 1) + t, 0)
            :: else
            fi
        };
        cluster_sync(t);
        d_step
        {
            load_all(t, RULE + 2 * (k - 1), 2);
            load_all(t, BLOCKS_ + 2 * k, 2);
            load(t, RULE + 2 * k + t);
            store(t, RULE + 2 * k + t, 1);
            if
            :: k + 1 < GRIDS ->
                atomic_same(t, RULE + 2 * (k + 1), old, 1);
                atomic_same(t, RULE + 2 * (k + 1) + 1, old, 1)
            :: else
            fi
        };
        k++
    :: else -> break
    od
}

proctype thread(byte t)
{
    bit turn;
    byte k, old;
    coarsen_chain_kernel(t)
}

START
