/* SPDX-License-Identifier: Apache-2.0 */
/* Kernels whose blocks share memory and know nothing of each other, one of them in each
 * run. Three threads each own a cell, and read those of the others.
 * code gpu/cloth/blocks.cu blocks_kernel: s= __syncthreads s __syncthreads
 * code gpu/cloth/springs.cuh springs_kernel: a a= a __syncthreads a= a __syncthreads a
 * code gpu/cloth/wind.cu wind_kernel: part __syncthreads part
 * code gpu/broad/cones.cu cones_mark_kernel: bit= __syncthreads bit __syncthreads
 * code gpu/solve/coarsen.cu coarsen_cut_kernel: n= __syncthreads atomicAdd cut= __syncthreads n cut
 * code gpu/narrow/audit_sort.cu check_kernel: high= __syncthreads atomicMax high __syncthreads atomicMax high
 * code gpu/narrow/narrow.cu filter_kernel: first= atomicAdd __syncthreads first
 * code gpu/solve/tile.cuh add_direction: __syncthreads __syncthreads
 * code gpu/solve/tile.cuh coarsen_tile_kernel: t __syncthreads t
 * code gpu/run/copies.cu scan_kernel: sum= __syncthreads sum __syncthreads sum= __syncthreads sum __syncthreads
 * code gpu/contact/zones.cu sum_members: __syncthreads __syncthreads
 * code gpu/contact/zones.cu zones_move_kernel: prescribed= __syncthreads prescribed= __syncthreads prescribed= prescribed __syncthreads
 * code gpu/broad/refit.cu refit_top_kernel: __syncthreads
 * code gpu/solve/joint.cu joint_curvature_kernel: __syncthreads
 */
#define THREADS 3
#define BLOCK 3
#define OWN 0  /* [THREADS] */
#define MORE 3 /* [THREADS] */
#define ONE 6
#define OUT 7
#define GLOBAL 7
#define CELLS 8
#include "memory.pml"

/* Two directions: all fill a tile, and then read all of it. */
inline blocks_kernel(t)
{
    round = 0;
    do
    :: round < 2 ->
        d_step { store(t, OWN + t, round) };
        block_sync(t);
        d_step { load_all(t, OWN, 3) };
        block_sync(t);
        round++
    :: else -> break
    od
}

inline springs_kernel(t)
{
    d_step { store(t, OWN + t, 1) };
    block_sync(t);
    d_step
    {
        load_all(t, OWN, 3);
        store(t, MORE + t, 1)
    };
    block_sync(t);
    d_step { load_all(t, MORE, 3) }
}

inline wind_kernel(t)
{
    d_step { store(t, OWN + t, 1) };
    block_sync(t);
    d_step { load_all(t, OWN, 3) }
}

/* The first thread joins the bits of all. */
inline cones_mark_kernel(t)
{
    round = 0;
    do
    :: round < 2 ->
        d_step { store(t, OWN + t, round) };
        block_sync(t);
        d_step
        {
            if
            :: t < 1 -> load_all(t, OWN, 3)
            :: else
            fi
        };
        block_sync(t);
        round++
    :: else -> break
    od
}

/* Two of three threads list themselves; all then read the list. */
inline coarsen_cut_kernel(t)
{
    d_step
    {
        if
        :: t == 0 -> store(t, ONE, 0)
        :: else
        fi
    };
    block_sync(t);
    if
    :: t != 1 ->
        d_step { atomic_of(t, ONE, old, value[ONE] + 1) };
        d_step { store(t, OWN + old, t) }
    :: else
    fi;
    block_sync(t);
    d_step
    {
        load(t, ONE);
        assert(value[ONE] == 2);
        load_all(t, OWN, 2);
        assert(value[OWN] + value[OWN + 1] == 2)
    }
}

/* The largest number of a block, and then of all blocks: the word is a maximum. */
inline check_kernel(t)
{
    d_step
    {
        if
        :: t == 0 -> store(t, ONE, 0)
        :: else
        fi
    };
    block_sync(t);
    d_step
    {
        old = value[ONE];
        most = (old < t -> t : old);
        atomic_of(t, ONE, old, most)
    };
    block_sync(t);
    d_step
    {
        if
        :: t == 0 ->
            load(t, ONE);
            assert(value[ONE] == 2);
            atomic_of(t, OUT, old, 2)
        :: else
        fi
    }
}

/* A block takes its places in a list at once. */
inline filter_kernel(t)
{
    if
    :: t == 0 ->
        d_step
        {
            atomic_of(t, OUT, old, value[OUT] + 2);
            store(t, ONE, old)
        }
    :: else
    fi;
    block_sync(t);
    d_step { load(t, ONE) }
}

inline add_direction(t)
{
    d_step { store(t, OWN + t, 1) };
    block_sync(t);
    d_step { load_all(t, OWN, 3) };
    block_sync(t)
}

inline coarsen_tile_kernel(t)
{
    add_direction(t);
    add_direction(t);
    d_step { store(t, OWN + t, 2) };
    block_sync(t);
    d_step { load_all(t, OWN, 3) }
}

inline scan_kernel(t)
{
    round = 0;
    do
    :: round < 2 ->
        d_step { store(t, OWN + t, t + 1) };
        block_sync(t);
        apart = 1;
        do
        :: apart < 3 ->
            d_step
            {
                before = 0;
                if
                :: t >= apart ->
                    load(t, OWN + t - apart);
                    before = value[OWN + t - apart]
                :: else
                fi
            };
            block_sync(t);
            d_step
            {
                load(t, OWN + t);
                before = value[OWN + t] + before;
                store(t, OWN + t, before)
            };
            block_sync(t);
            apart = 2 * apart
        :: else -> break
        od;
        true;
        d_step
        {
            load(t, OWN + t);
            load(t, OWN + 2);
            assert(value[OWN + t] == (t + 1) * (t + 2) / 2);
            assert(value[OWN + 2] == 6)
        };
        block_sync(t);
        round++
    :: else -> break
    od
}

/* A tree over six members of which each thread wrote two. */
inline sum_members(t)
{
    block_sync(t);
    apart = 1;
    do
    :: apart < 6 ->
        d_step
        {
            place = 2 * apart * t;
            do
            :: place + apart < 6 ->
                load(t, OWN + place);
                load(t, OWN + place + apart);
                before = value[OWN + place] + value[OWN + place + apart];
                store(t, OWN + place, before);
                place = place + 6 * apart
            :: else -> break
            od
        };
        block_sync(t);
        apart = 2 * apart
    :: else -> break
    od
}

inline put_members(t)
{
    d_step
    {
        store(t, OWN + t, t);
        store(t, OWN + t + 3, t + 3)
    }
}

/* Each thread sets the flag to 0; those that have prescribed members set it to 1. */
inline zones_move_kernel(t)
{
    d_step { atomic_same(t, ONE, old, 0) };
    block_sync(t);
    d_step
    {
        if
        :: t != 1 -> atomic_same(t, ONE, old, 1)
        :: else
        fi
    };
    block_sync(t);
    d_step
    {
        load(t, ONE);
        assert(value[ONE] == 1)
    };
    put_members(t);
    sum_members(t);
    true;
    d_step
    {
        load(t, OWN);
        assert(value[OWN] == 15)
    };
    block_sync(t);
    put_members(t);
    sum_members(t);
    true;
    d_step
    {
        load(t, OWN);
        assert(value[OWN] == 15)
    }
}

/* Two levels of a tree: nodes read children that other threads wrote. */
inline refit_top_kernel(t)
{
    round = 0;
    do
    :: round < 2 ->
        d_step
        {
            if
            :: round -> load_all(t, OWN, 3)
            :: else
            fi;
            store(t, OWN + 3 * round + t, 1)
        };
        block_sync(t);
        round++
    :: else -> break
    od
}

/* A warp writes q of a vertex whose thread then reads it. */
inline joint_curvature_kernel(t)
{
    d_step { store(t, OWN + (t + 1) % 3, 1) };
    block_sync(t);
    d_step { load(t, OWN + t) }
}

byte kernel;

proctype thread(byte t)
{
    bit turn;
    byte round, old, most, apart, before, place;
    if
    :: kernel == 0 -> blocks_kernel(t)
    :: kernel == 1 -> springs_kernel(t)
    :: kernel == 2 -> wind_kernel(t)
    :: kernel == 3 -> cones_mark_kernel(t)
    :: kernel == 4 -> coarsen_cut_kernel(t)
    :: kernel == 5 -> check_kernel(t)
    :: kernel == 6 -> coarsen_tile_kernel(t)
    :: kernel == 7 -> scan_kernel(t)
    :: kernel == 8 -> zones_move_kernel(t)
    :: kernel == 9 -> refit_top_kernel(t)
    :: kernel == 11 -> filter_kernel(t)
    :: kernel == 10 -> joint_curvature_kernel(t)
    fi
}

init
{
    begin_memory();
    atomic
    {
        do
        :: kernel < 11 -> kernel++
        :: break
        od;
        run thread(0);
        run thread(1);
        run thread(2)
    }
}
