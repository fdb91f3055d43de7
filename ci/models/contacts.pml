/* SPDX-License-Identifier: Apache-2.0 */
/* The passes over contacts, by a cluster or a whole grid: two blocks of a thread each,
 * two contacts, which share two vertices. An iteration counts the contacts that act, and
 * is void where any count is over. No thread may read that word later than the next
 * iteration writes it.
 * code gpu/contact/contacts.cu pass: group_sync<GRID>
 * code gpu/contact/contacts.cu solve_normal: group_sync<GRID> group_sync<GRID>
 * code gpu/contact/contacts.cu contacts_kernel: row= row group_sync<GRID>
 * code gpu/contact/contacts.cuh count: atomicAdd
 */
#define THREADS 2
#define BLOCK 1
#define GLOBAL 0
#define U 0      /* [2] velocities of the vertices, thread t's is t */
#define ACTING 2 /* [2] */
#define PARTS 4  /* [2] */
#define PUSHED 6 /* [2][2] of a contact at a vertex, 2 contact + vertex */
#define OVER 10
#define LONGER 11
#define CELLS 12
#include "memory.pml"

#define PUSH(of_, at_) (PUSHED + 2 * (of_) + (at_))

inline pass(t)
{
    cluster_sync(t)
}

inline count(t)
{
    over = 0;
    j = 0;
    do
    :: j < 2 ->
        d_step { atomic_of(t, ACTING + j, old, value[ACTING + j] + 1) };
        over = over || old + 1 > 1;
        j++
    :: else -> break
    od;
    true
}

/* Thread t's contact: lacks, and pushes both vertices. */
inline push(t)
{
    d_step
    {
        store(t, PUSH(t, 0), 0);
        store(t, PUSH(t, 1), 0)
    };
    pass(t)
}

/* Thread t's vertex: sums the pushes of all contacts. */
inline apply(t)
{
    d_step
    {
        load(t, LONGER);
        load(t, PUSH(0, t));
        load(t, PUSH(1, t));
        load(t, U + t);
        store(t, U + t, 0)
    }
}

inline solve_normal(t)
{
    round = 0;
    do
    :: round < 2 ->
        d_step
        {
            load_all(t, U, 2);
            load_all(t, PARTS, 2)
        };
        count(t);
        d_step
        {
            if
            :: over -> atomic_same(t, OVER, old, round + 1)
            :: else
            fi
        };
        cluster_sync(t);
        d_step
        {
            load(t, OVER);
            over = value[OVER] == round + 1
        };
        push(t);
        apply(t);
        d_step
        {
            load(t, ACTING + t);
            store(t, ACTING + t, 0);
            if
            :: !over -> store(t, PARTS + t, 0)
            :: else
            fi
        };
        cluster_sync(t);
        round++
    :: else -> break
    od
}

inline contacts_kernel(t)
{
    d_step
    {
        store(t, ACTING + t, 0);
        store(t, PARTS + t, 0);
        atomic_same(t, LONGER, old, 1)
    };
    pass(t);
    d_step { load_all(t, U, 2) };
    pass(t);
    solve_normal(t);
    true;
    d_step { load_all(t, U, 2) };
    pass(t);
    round = 0;
    do
    :: round < 2 ->
        d_step { load_all(t, U, 2) };
        push(t);
        apply(t);
        cluster_sync(t);
        round++
    :: else -> break
    od;
    push(t);
    apply(t)
}

proctype thread(byte t)
{
    bit turn, over;
    byte old, round, j;
    contacts_kernel(t)
}

START
