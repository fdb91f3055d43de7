/* SPDX-License-Identifier: Apache-2.0 */
/* Sums of two chunks in a row; then the tree over two or five chunk sums, level by level, twice
 * in a row as moments_kernel makes it. A block of two warps of one lane each: lanes
 * exchange values without memory.
 * code gpu/base/sum.cuh chunk_sums: __syncthreads s= __syncthreads s
 * code gpu/base/sum.cuh put_level: __syncthreads __syncthreads
 * code gpu/base/sum.cuh finish_sums: last= __syncthreads last
 * code gpu/momentum/momentum.cu moments_kernel: __syncthreads
 */
#define THREADS 2
#define BLOCK 2
#define CHUNK 2 /* and so many chunks at once */
#define LAST 1  /* chunk sums that are kept in shared memory */
#define S 0     /* [CHUNK] */
#define KEPT 2  /* [LAST], each for a run */
#define RUNS 3  /* [2][5] chunk sums of two runs, in global memory */
#define GLOBAL 3
#define CELLS 13
#include "memory.pml"

byte chunk_count; /* with 2 no level stays in global memory */

inline chunk_sums(t, item)
{
    block_sync(t);
    d_step { store(t, S + t, item) };
    block_sync(t);
    d_step
    {
        load(t, S);
        load(t, S + 1);
        sum = value[S] + value[S + 1]
    }
}

/* The sum of chunk base + t of a level at `from`. */
inline level_sums(t)
{
    d_step
    {
        sum = 0;
        k = 0;
        do
        :: k < CHUNK ->
            if
            :: CHUNK * (base + t) + k < many ->
                load(t, from + CHUNK * (base + t) + k);
                sum = sum + value[from + CHUNK * (base + t) + k]
            :: else
            fi;
            k++
        :: else -> break
        od;
        k = 0
    }
}

inline put_level(t)
{
    base = 0;
    chunks = (many + CHUNK - 1) / CHUNK;
    do
    :: base < chunks ->
        level_sums(t);
        block_sync(t);
        d_step
        {
            if
            :: base + t < chunks -> store(t, from + base + t, sum)
            :: else
            fi
        };
        block_sync(t);
        base = base + CHUNK
    :: else -> break
    od;
    many = chunks
}

inline finish_sums(t)
{
    many = chunk_count;
    do
    :: many > LAST * CHUNK -> put_level(t)
    :: else -> break
    od;
    base = 0;
    level_sums(t);
    d_step
    {
        if
        :: t == 0 -> store(t, KEPT, sum)
        :: else
        fi
    };
    block_sync(t);
    d_step
    {
        load(t, KEPT);
        sum = value[KEPT]
    }
}

inline moments_kernel(t)
{
    from = RUNS;
    finish_sums(t);
    assert(sum == BIT(chunk_count) - 1);
    block_sync(t);
    from = RUNS + 5;
    finish_sums(t);
    assert(sum == BIT(chunk_count) - 1)
}

proctype thread(byte t)
{
    bit turn;
    byte sum, k, base, chunks, many, from;
    d_step
    {
        /* thread 0 has the chunk sums from a kernel before */
        k = 0;
        do
        :: k < 5 && t == 0 ->
            value[RUNS + k] = BIT(k);
            value[RUNS + 5 + k] = BIT(k);
            k++
        :: else -> break
        od;
        k = 0
    };
    chunk_sums(t, t + 1);
    assert(sum == 3);
    chunk_sums(t, t + 3);
    assert(sum == 7);
    moments_kernel(t)
}

init
{
    begin_memory();
    atomic
    {
        if
        :: chunk_count = 2
        :: chunk_count = 5
        fi;
        run thread(0);
        run thread(1)
    }
}
