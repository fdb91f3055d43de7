/* SPDX-License-Identifier: Apache-2.0 */
/* The scan of a block, twice in a row; of five threads four count.
 * code gpu/base/scan.cuh block_scan: __syncthreads s= __syncthreads s s= run= __syncthreads run s
 */
#define THREADS 5
#define BLOCK 5
#define COUNTING 4
#define RUN 2
#define S 0 /* [6]: each run has a gap behind it */
#define R 6
#define CELLS 8
#include "memory.pml"

inline block_scan(t, count)
{
    block_sync(t);
    d_step
    {
        at = (t < COUNTING -> S + t + t / RUN : S);
        if
        :: t < COUNTING -> store(t, at, count)
        :: else
        fi
    };
    block_sync(t);
    d_step
    {
        if
        :: t < COUNTING / RUN ->
            sum = 0;
            k = t * (RUN + 1);
            do
            :: k < (t + 1) * (RUN + 1) - 1 ->
                load(t, S + k);
                here = value[S + k];
                store(t, S + k, sum);
                sum = sum + here;
                k++
            :: else -> break
            od;
            store(t, R + t, sum)
        :: else
        fi
    };
    block_sync(t);
    d_step
    {
        before = 0;
        all = 0;
        k = 0;
        do
        :: k < COUNTING / RUN ->
            load(t, R + k);
            before = (k == t / RUN -> all : before);
            all = all + value[R + k];
            k++
        :: else -> break
        od;
        load(t, at);
        before = before + value[at];
        k = 0;
        sum = 0;
        here = 0
    }
}

proctype thread(byte t)
{
    bit turn;
    byte at, sum, here, before, all, k;
    block_scan(t, t + 1);
    assert(all == 10 && (t >= COUNTING || before == t * (t + 1) / 2));
    block_scan(t, 1);
    assert(all == 4 && (t >= COUNTING || before == t))
}

START
