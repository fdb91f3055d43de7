/* SPDX-License-Identifier: Apache-2.0 */
/* The inversion of a group's matrix, of three unknowns, and its product, by two threads
 * that each have one lane of a warp. The matrix, the column that is swept and what tells
 * whether an unknown was lie in global memory.
 * code gpu/solve/sewn.cu sewn_invert_kernel: __syncthreads __syncthreads
 * code gpu/solve/sewn.cu sewn_solve_kernel: __syncthreads
 */
#define THREADS 2
#define BLOCK 2
#define N 3
#define MATRIX 0   /* [N][N] */
#define COLUMN 9   /* [N] */
#define INVERSE 12 /* [N] */
#define IN 15      /* [N] */
#define CELLS 18
#include "memory.pml"

/* Reads a thread's part of column k of the lower triangle, and keeps it. */
inline take_column(t, k)
{
    i = t;
    do
    :: i < N ->
        if
        :: i < k -> load(t, MATRIX + k * N + i)
        :: else -> load(t, MATRIX + i * N + k)
        fi;
        store(t, COLUMN + i, 0);
        i = i + THREADS
    :: else -> break
    od
}

/* Sweeps a thread's rows; at the end, `last`, mirrors them. */
inline sweep_rows(t, last)
{
    i = t;
    do
    :: i < N ->
        j = 0;
        do
        :: j <= i ->
            load(t, (last -> INVERSE : COLUMN) + i);
            load(t, (last -> INVERSE : COLUMN) + j);
            load(t, MATRIX + i * N + j);
            store(t, MATRIX + i * N + j, 0);
            if
            :: last && i != j -> store(t, MATRIX + j * N + i, 0)
            :: else
            fi;
            j = j + 1
        :: else -> break
        od;
        i = i + THREADS
    :: else -> break
    od
}

inline sewn_invert_kernel(t)
{
    d_step { load(t, MATRIX); load(t, MATRIX + 4); load(t, MATRIX + 8) };
    k = 0;
    do
    :: k < N ->
        d_step { load(t, MATRIX + k * N + k); take_column(t, k) };
        block_sync(t);
        d_step
        {
            if
            :: t == 0 -> store(t, INVERSE + k, 0)
            :: else
            fi;
            sweep_rows(t, false)
        };
        block_sync(t);
        k = k + 1
    :: else -> break
    od;
    true;
    d_step { sweep_rows(t, true) }
}

inline sewn_solve_kernel(t)
{
    d_step
    {
        store(t, IN + t, 0);
        if
        :: t == 0 -> store(t, IN + 2, 0)
        :: else
        fi
    };
    block_sync(t);
    d_step { load_all(t, IN, N) }
}

proctype thread(byte t)
{
    bit turn;
    byte i, j, k;
    sewn_invert_kernel(t);
    sewn_solve_kernel(t)
}

START
