/* SPDX-License-Identifier: Apache-2.0 */
/* Items count themselves into the words of their vertices: each gets a rank of its own,
 * and a vertex counts once in the word's upper half, whatever the order. Three items,
 * each of any of two vertices.
 * code gpu/contact/incidence.cu incidence_count_kernel: atomicAdd atomicAdd
 * code gpu/contact/contacts.cuh first_parts: atomicAdd
 */
#define THREADS 3
#define BLOCK 3
#define GLOBAL 0
#define UPPER 16
#define CELLS 3 /* two words, and a list's length */
#include "memory.pml"

byte ranks[2]; /* masks of those that were given */
byte items[2], listed, ended;

inline incidence_count_kernel(t)
{
    if
    :: FAULT(read_and_then_written) ->
        old = value[vertex];
        value[vertex] = old + 1
    :: else -> d_step { atomic_of(t, vertex, old, value[vertex] + 1) }
    fi;
    rank = old % UPPER;
    if
    :: rank == 0 -> d_step { atomic_of(t, vertex, old, value[vertex] + UPPER) }
    :: else
    fi
}

/* Appends to a list, in any order: each item has its own place. */
inline first_parts(t)
{
    d_step
    {
        atomic_of(t, 2, old, value[2] + 1);
        assert(!(listed & BIT(old)));
        listed = listed | BIT(old)
    }
}

proctype thread(byte t)
{
    byte vertex, old, rank;
    if
    :: vertex = 0
    :: vertex = 1
    fi;
    incidence_count_kernel(t);
    d_step
    {
        assert(!(ranks[vertex] & BIT(rank)));
        ranks[vertex] = ranks[vertex] | BIT(rank);
        items[vertex]++
    };
    first_parts(t);
    d_step
    {
        ended++;
        if
        :: ended == THREADS ->
            assert(listed == BIT(THREADS) - 1);
            vertex = 0;
            do
            :: vertex < 2 ->
                assert(ranks[vertex] == BIT(items[vertex]) - 1);
                assert(value[vertex] % UPPER == items[vertex]);
                assert(value[vertex] / UPPER == (items[vertex] > 0));
                vertex++
            :: else -> break
            od
        :: else
        fi
    }
}

START
