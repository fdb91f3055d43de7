/* SPDX-License-Identifier: Apache-2.0 */
/* The inversion of the coarsest operator, of three unknowns by two threads. Each keeps
 * its entries of the lower triangle in registers, and two columns are in turn in one of
 * two places.
 * code gpu/solve/coarsest.cu coarsest_invert_kernel: block= block __syncthreads block diagonal= columns __syncthreads diagonal columns parked= columns __syncthreads parked
 */
#define THREADS 2
#define BLOCK 2
#define N 3
#define PUT 0      /* [2] the blocks of the matrix */
#define DIAGONAL 2 /* [N] */
#define PARKED 5   /* [N] */
#define COLUMN 8   /* [2][2][N] */
#define CELLS 20
#include "memory.pml"

/* Puts the thread's entries of columns k and k + 1 into their place. */
inline keep(t, which, k)
{
    e = t;
    do
    :: e < N * (N + 1) / 2 ->
        row = (e > 2 -> 2 : (e > 0 -> 1 : 0));
        col = e - row * (row + 1) / 2;
        if
        :: col == k -> store(t, COLUMN + 2 * N * (which) + row, 0)
        :: else ->
            if
            :: row == k -> store(t, COLUMN + 2 * N * (which) + col, 0)
            :: else
            fi
        fi;
        if
        :: col == k + 1 -> store(t, COLUMN + 2 * N * (which) + N + row, 0)
        :: else ->
            if
            :: row == k + 1 -> store(t, COLUMN + 2 * N * (which) + N + col, 0)
            :: else
            fi
        fi;
        e = e + THREADS
    :: else -> break
    od
}

inline coarsest_invert_kernel(t)
{
    d_step { store(t, PUT + t, 0) };
    block_sync(t);
    d_step
    {
        load_all(t, PUT, 2);
        if
        :: t == 0 ->
            store(t, DIAGONAL, 0);
            store(t, DIAGONAL + 1, 0)
        :: else -> store(t, DIAGONAL + 2, 0)
        fi;
        keep(t, 0, 0)
    };
    block_sync(t);
    d_step { load_all(t, DIAGONAL, N) };
    k = 0;
    do
    :: k < N ->
        d_step
        {
            load_all(t, COLUMN + 2 * N * (k / 2 % 2), 2 * N);
            if
            :: t < 2 && k + t < N -> store(t, PARKED + k + t, 0)
            :: else
            fi;
            if
            :: k + 2 < N -> keep(t, (k / 2 + 1) % 2, k + 2)
            :: else
            fi
        };
        block_sync(t);
        k = k + 2
    :: else -> break
    od;
    true;
    d_step { load_all(t, PARKED, N) }
}

proctype thread(byte t)
{
    bit turn;
    byte e, row, col, k;
    coarsest_invert_kernel(t)
}

START
