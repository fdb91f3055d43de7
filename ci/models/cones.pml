/* SPDX-License-Identifier: Apache-2.0 */
/* The top levels of the cones, in one cluster: two ranks of two threads, two levels of
 * nodes, and the nodes' bits: first by themselves, then by those of the nodes above. In
 * this phase a bit that is read may be final already, which is the same.
 * code gpu/broad/cones.cu mark_top: cluster_sync(!entire) cluster_sync(false)
 * code gpu/broad/cones.cu cones_top_kernel: cluster_sync(false)
 */
#define THREADS 4
#define BLOCK 2
#define MARK 0 /* [BLOCKS][BLOCK] bits, in shared memory */
#define GLOBAL 4
#define NODES 4 /* [2][THREADS] tangents: the second level reads the first */
#define CLEAR 12 /* [2][BLOCKS] of two rounds of nodes */
#define CELLS 16
#include "memory.pml"

/* Two threads share a node; the first joins both bits. A node reads nodes above. */
inline mark_top(t, entire)
{
    round = 0;
    do
    :: round < 2 ->
        d_step
        {
            load_all(t, NODES, 8);
            if
            :: entire -> load_all(t, CLEAR, 4)
            :: else
            fi;
            store(t, MARK + t, 1)
        };
        cluster_sync_unless(t, !(entire));
        d_step
        {
            if
            :: t % BLOCK == 0 ->
                load_all(t, MARK + t, 2);
                if
                :: entire -> load(t, CLEAR + 2 * round + t / BLOCK)
                :: else
                fi;
                store(t, CLEAR + 2 * round + t / BLOCK, 1)
            :: else
            fi
        };
        cluster_sync(t);
        round++
    :: else -> break
    od
}

inline cones_top_kernel(t)
{
    round = 0;
    do
    :: round < 2 ->
        d_step
        {
            if
            :: round -> load_all(t, NODES, 4)
            :: else
            fi;
            store(t, NODES + 4 * round + t, 0)
        };
        cluster_sync(t);
        round++
    :: else -> break
    od;
    mark_top(t, false);
    mark_top(t, true)
}

proctype thread(byte t)
{
    bit turn;
    byte round;
    cones_top_kernel(t)
}

START
