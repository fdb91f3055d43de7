/* SPDX-License-Identifier: Apache-2.0 */
/* The small grids of a multigrid cycle in one cluster: two ranks of two threads, and a
 * grid that the ranks share, one that each has whole, and the coarsest; or that alone.
 * Ranks read each other's shared memory, which must not end before; copies from global
 * memory land at any time until their thread waits for them.
 * code gpu/solve/tail.cuh fetch_patches: copies_group copies_group
 * code gpu/solve/tail.cuh fetch_rules: atomicAdd
 * code gpu/solve/tail.cuh fetch_all: copies_group cluster_sync_shared(true) copies_end<2> copies_end<0> cluster_sync_shared(true)
 * code gpu/solve/tail.cuh open_first: cluster_sync_shared(true)
 * code gpu/solve/tail.cuh patch_sync: cluster_sync_shared(l->replicated)
 * code gpu/solve/tail.cuh find_left: copies_end<1> copies_end<0> patch_sync(l)
 * code gpu/solve/tail.cuh restrict_patch: cluster_sync_shared(true)
 * code gpu/solve/tail.cuh solve_coarsest: cluster_sync_shared(true) cluster_sync_shared(true)
 * code gpu/solve/tail.cuh prolong_patch: cluster_sync_shared(true)
 * code gpu/solve/tail.cuh smooth_up: patch_sync(l)
 * code gpu/solve/tail.cuh raise_fine: cluster_sync_shared(false)
 * code gpu/solve/patch.cuh owned: cluster_at
 */
#define THREADS 4
#define BLOCK 2
/* Of a rank: x, the residual and y of three grids, which have 4, 2 and 2 particles. The
 * first grid's x and residual are of the particles that the rank owns. */
#define X0 0
#define LEFT0 2
#define Y0 4
#define X1 8
#define LEFT1 10
#define Y1 12
#define X2 14
#define RULED 16
#define RULES 17
/* What is copied: coefficients of two grids and the coarsest's inverse, a cell by each
 * thread. */
#define COPIES 19
#define RANK 25
#define GLOBAL 50
#define FINE 50 /* [THREADS] */
#define CELLS 54
#define MINE(k) (t / BLOCK * RANK + (k))
#define OWN(k) (MINE(k) + t % BLOCK)
#include "memory.pml"

bit raises;
byte levels;
byte flight[CELLS]; /* 1 + the group of a copy under way; 0: none */

inline copy_ahead(t, which)
{
    d_step
    {
        store(t, OWN(COPIES + 2 * which), 0);
        written[OWN(COPIES + 2 * which)] = 0;
        flight[OWN(COPIES + 2 * which)] = 1 + groups
    }
}

inline copies_group(t)
{
    groups++
}

/* Waits for the thread's copies but those of the last `later` groups. */
inline copies_end(t, later)
{
    d_step
    {
        k = 0;
        do
        :: k < 3 ->
            if
            :: flight[OWN(COPIES + 2 * k)] && flight[OWN(COPIES + 2 * k)] <= groups - later ->
                flight[OWN(COPIES + 2 * k)] = 0;
                written[OWN(COPIES + 2 * k)] = BIT(t)
            :: else
            fi;
            k++
        :: else -> break
        od;
        k = 0
    }
}

inline fetch_patches(t)
{
    if
    :: levels > 1 -> copy_ahead(t, 0)
    :: else
    fi;
    copies_group(t);
    if
    :: levels > 1 -> copy_ahead(t, 1)
    :: else
    fi;
    copies_group(t)
}

inline fetch_rules(t)
{
    d_step
    {
        store(t, OWN(RULES), 1);
        atomic_of(t, MINE(RULED), old, 1)
    }
}

inline fetch_vectors(t)
{
    d_step
    {
        store(t, OWN(Y0), 0);
        store(t, OWN(Y0) + 2, 0);
        store(t, OWN(X0), 0)
    }
}

inline open_first(t)
{
    d_step
    {
        load_all(t, MINE(COPIES), 2);
        load(t, OWN(Y0));
        load(t, OWN(Y0) + 2);
        store(t, OWN(Y0), 0);
        store(t, OWN(Y0) + 2, 0)
    };
    block_sync(t)
}

inline fetch_all(t)
{
    d_step
    {
        if
        :: t % BLOCK == 0 -> store(t, MINE(RULED), 0)
        :: else
        fi
    };
    fetch_patches(t);
    copy_ahead(t, 2);
    copies_group(t);
    block_sync(t);
    fetch_rules(t);
    fetch_vectors(t);
    if
    :: levels > 1 -> copies_end(t, 2)
    :: else -> copies_end(t, 0)
    fi;
    block_sync(t);
    if
    :: levels > 1 -> open_first(t)
    :: else
    fi
}

inline patch_sync(t, grid)
{
    cluster_sync_shared_unless(t, grid == 1)
}

inline find_left(t, grid, later)
{
    d_step
    {
        load_all(t, MINE((grid == 0 -> Y0 : Y1)), 4 - 2 * grid);
        load_all(t, MINE(COPIES + 2 * grid), 2);
        load(t, OWN((grid == 0 -> X0 : X1)));
        store(t, OWN((grid == 0 -> LEFT0 : LEFT1)), 0)
    };
    if
    :: later -> copies_end(t, 1)
    :: else -> copies_end(t, 0)
    fi;
    patch_sync(t, grid)
}

/* To the second grid, which is smoothed at once; or to the coarsest, which is not. */
inline restrict_patch(t, grid)
{
    d_step
    {
        load_all(t, MINE(RULES), 2);
        if
        :: grid == 0 ->
            load_all(t, LEFT0, 2);
            load_all(t, RANK + LEFT0, 2);
            load_all(t, MINE(COPIES + 2), 2);
            store(t, OWN(X1), 0);
            store(t, OWN(Y1), 0)
        :: else ->
            load_all(t, MINE(LEFT1), 2);
            store(t, OWN(X2), 0)
        fi
    };
    block_sync(t)
}

inline solve_coarsest(t)
{
    d_step
    {
        load_all(t, MINE((levels > 1 -> X2 : X0)), 2);
        load_all(t, MINE(COPIES + 4), 2)
    };
    block_sync(t);
    d_step { store(t, OWN((levels > 1 -> X2 : X0)), 0) };
    block_sync(t)
}

inline prolong_patch(t, grid)
{
    d_step
    {
        load_all(t, MINE(RULES), 2);
        load_all(t, MINE((grid == 0 -> X1 : X2)), 2);
        if
        :: grid == 0 ->
            load(t, OWN(Y0));
            load(t, OWN(Y0) + 2);
            store(t, OWN(Y0), 0);
            store(t, OWN(Y0) + 2, 0)
        :: else ->
            load(t, OWN(Y1));
            store(t, OWN(Y1), 0)
        fi
    };
    block_sync(t)
}

inline smooth_up(t, grid)
{
    d_step
    {
        load_all(t, MINE((grid == 0 -> Y0 : Y1)), 4 - 2 * grid);
        load_all(t, MINE(COPIES + 2 * grid), 2);
        load(t, OWN((grid == 0 -> X0 : X1)));
        if
        :: grid > 0 || raises -> store(t, OWN((grid == 0 -> X0 : X1)), 0)
        :: else
        fi
    };
    patch_sync(t, grid)
}

inline raise_fine(t)
{
    d_step
    {
        if
        :: levels > 1 ->
            load_all(t, X0, 2);
            load_all(t, RANK + X0, 2)
        :: else -> load_all(t, MINE(X0), 2)
        fi;
        store(t, FINE + t, 0)
    };
    cluster_sync_shared(t)
}

inline cycle(t)
{
    if
    :: levels > 1 ->
        find_left(t, 0, 1);
        restrict_patch(t, 0);
        find_left(t, 1, 0);
        restrict_patch(t, 1)
    :: else
    fi;
    solve_coarsest(t);
    if
    :: levels > 1 ->
        prolong_patch(t, 1);
        smooth_up(t, 1);
        prolong_patch(t, 0);
        smooth_up(t, 0)
    :: else
    fi;
    if
    :: raises -> raise_fine(t)
    :: else
    fi
}

/* A rank's memory may end only after what others read of it. */
inline finish(t)
{
    d_step
    {
        k = 0;
        do
        :: k < RANK * THREADS ->
            assert(k % THREADS / BLOCK == t / BLOCK ||
                   by_read[MINE(0) * THREADS + k] & BIT(t));
            k++
        :: else -> break
        od;
        k = 0
    }
}

proctype thread(byte t)
{
    bit turn;
    byte old, k, groups;
    fetch_all(t);
    d_step { load(t, MINE(RULED)) };
    cycle(t);
    true;
    finish(t)
}

init
{
    begin_memory();
    atomic
    {
        if
        :: levels = 1
        :: levels = 3
        fi;
        if
        :: raises = 0
        :: raises = 1
        fi;
        run thread(0);
        run thread(1);
        run thread(2);
        run thread(3)
    }
}
