/* SPDX-License-Identifier: Apache-2.0 */
/* The tiles of a walk: a block of two threads makes two passes over two tiles. All
 * threads take turns at the children of each item. What the block keeps in shared memory
 * is used by one tile after another.
 * code gpu/broad/walk.cu begin: __syncthreads
 * code gpu/broad/walk.cu test_children: w kids= item= w= kids= __syncthreads kids item atomicOr w w= atomicAdd w __syncthreads w
 * code gpu/broad/walk.cu test_leaves: w __syncthreads atomicOr w __syncthreads w
 * code gpu/broad/walk.cu emit: before= __syncthreads before
 */
#define THREADS 2
#define BLOCK 2
#define MASK 0 /* [BLOCK] children that pass */
#define STOPPED 2
#define DEEPER 3
#define ITEM 4   /* [BLOCK] */
#define KIDS 6   /* [BLOCK] */
#define BEFORE 8 /* [BLOCK] */
#define SCAN 10  /* [BLOCK] the memory of block_scan */
#define SUM 12   /* [2] of tiles, in global memory, as place is */
#define PLACE 14
#define GLOBAL 12
#define CELLS 16
#include "memory.pml"

#define block_sync_of_scan(t) block_sync(t)

/* As scan.pml shows, the counts of all threads come together. */
inline scan(t)
{
    block_sync_of_scan(t);
    d_step { store(t, SCAN + t, 0) };
    block_sync_of_scan(t);
    d_step { load_all(t, SCAN, 2) }
}

inline count(t)
{
    d_step { load(t, MASK + t) };
    scan(t);
    d_step
    {
        if
        :: t == 0 ->
            load(t, STOPPED);
            load(t, DEEPER);
            store(t, SUM + tile, value[MASK])
        :: else
        fi
    }
}

inline begin(t)
{
    block_sync(t); /* spare: the tile before ends behind a barrier of its scan */
    d_step
    {
        store(t, MASK + t, 0);
        if
        :: t == 0 ->
            store(t, STOPPED, 0);
            store(t, DEEPER, 0)
        :: else
        fi
    }
}

/* Thread t tests child t of both items; each passes or not. */
inline test_children(t)
{
    begin(t);
    d_step
    {
        store(t, KIDS + t, 0);
        store(t, ITEM + t, 0);
        if
        :: leaf -> store(t, MASK + t, 1) /* a pair of leaves is its own child */
        :: else -> store(t, KIDS + t, 3)
        fi
    };
    block_sync(t);
    d_step
    {
        load_all(t, KIDS, 2);
        if
        :: value[KIDS] -> load_all(t, ITEM, 2)
        :: else
        fi
    };
    if
    :: value[KIDS] ->
        if
        :: d_step
           {
               atomic_of(t, MASK, old, value[MASK] | BIT(t));
               atomic_same(t, DEEPER, old, 1)
           }
        :: d_step { atomic_same(t, MASK + 1, old, value[MASK + 1] | BIT(t)) }
        fi
    :: else
    fi;
    if
    :: true -> d_step { atomic_of(t, STOPPED, old, value[STOPPED] + 1) }
    :: true
    fi;
    block_sync(t);
    count(t)
}

inline test_leaves(t)
{
    begin(t);
    block_sync(t);
    d_step
    {
        atomic_of(t, MASK, old, value[MASK] | BIT(t));
        atomic_same(t, MASK + 1, old, value[MASK + 1] | BIT(t))
    };
    block_sync(t);
    count(t)
}

/* All threads add up the sums of all tiles; each keeps the place of its own. */
inline put_places(t)
{
    d_step { load(t, SUM + t) };
    scan(t);
    d_step { store(t, PLACE + t, 0) }
}

inline emit(t)
{
    scan(t);
    d_step { store(t, BEFORE + t, 0) };
    block_sync(t);
    d_step
    {
        load_all(t, BEFORE, 2);
        load(t, PLACE + tile)
    }
}

/* The barriers between passes are those of passes.pml. */
proctype thread(byte t)
{
    bit turn, leaf;
    byte tile, old, pass;
    do
    :: pass < 3 ->
        tile = 0;
        do
        :: tile < 2 ->
            if
            :: pass < 2 ->
                leaf = pass;
                test_children(t)
            :: else -> test_leaves(t)
            fi;
            tile++
        :: else -> break
        od;
        block_sync_of_scan(t);
        put_places(t);
        tile = 0;
        do
        :: tile < 2 ->
            emit(t);
            tile++
        :: else -> break
        od;
        block_sync_of_scan(t);
        pass++
    :: else -> break
    od
}

START
