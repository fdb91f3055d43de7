/* SPDX-License-Identifier: Apache-2.0 */
/* Connected components by labels that threads lower without locks. Three threads join
 * four items, each one pair of any; when all have ended, the end of each item's chain is
 * the smallest item of its component. Then each thread makes an item's label its root. All accesses are volatile or atomic.
 * code gpu/base/unite.cuh root_of:
 * code gpu/base/unite.cuh unite: atomicCAS
 * code gpu/momentum/momentum.cu islands_root_kernel: volatile
 */
#define THREADS 3
#define BLOCK 3
#define CELLS 4
#include "memory.pml"


byte root[4]; /* the smallest items */
bit joined[16]; /* whether items i and j are in one component, i + 4 j */

inline root_of(start)
{
    i = start;
    at = value[i];
    to = value[at];
    do
    :: to != at ->
        /* another thread may have lowered this label meanwhile */
        value[i] = to;
        i = at;
        at = to;
        to = value[at]
    :: else -> break
    od
}

inline unite(t, first, second)
{
    root_of(first);
    a = at;
    root_of(second);
    b = at;
    do
    :: a != b ->
        hi = (a < b -> b : a);
        lo = (a < b -> a : b);
        if
        :: FAULT(no_compare) ->
            d_step
            {
                atomic_same(t, hi, old, lo);
                old = hi
            }
        :: else ->
            d_step
            {
                old = value[hi];
                to = (old == hi -> lo : old);
                atomic_of(t, hi, old, to)
            }
        fi;
        if
        :: old == hi -> break
        :: else
        fi;
        root_of(old);
        a = at;
        if
        :: FAULT(forgets_a_side) -> b = a
        :: else ->
            root_of(lo);
            b = at
        fi
    :: else -> break
    od
}

/* No label of the item's own changes but by itself: others only read it. */
inline islands_root_kernel(item)
{
    at = item;
    do
    :: value[at] != at -> at = value[at]
    :: else -> break
    od;
    value[item] = at
}

byte ended;
byte m_, n_, s_, j_;
inline check()
{
    m_ = 0;
    do
    :: m_ < 3 ->
        s_ = 0;
        do
        :: s_ < 4 ->
            n_ = 0;
            do
            :: n_ < 4 ->
                if
                :: (joined[s_ + 4 * n_] || s_ == n_) ->
                    j_ = 0;
                    do
                    :: j_ < 4 ->
                        if
                        :: joined[n_ + 4 * j_] ->
                            joined[s_ + 4 * j_] = 1;
                            joined[j_ + 4 * s_] = 1
                        :: else
                        fi;
                        j_++
                    :: else -> break
                    od
                :: else
                fi;
                n_++
            :: else -> break
            od;
            s_++
        :: else -> break
        od;
        m_++
    :: else -> break
    od;
    s_ = 0;
    do
    :: s_ < 4 ->
        n_ = s_;
        do
        :: value[n_] != n_ ->
            assert(value[n_] < n_);
            n_ = value[n_]
        :: else -> break
        od;
        m_ = 0;
        do
        :: m_ < s_ && !joined[s_ + 4 * m_] -> m_++
        :: else -> break
        od;
        assert(n_ == m_);
        root[s_] = m_;
        s_++
    :: else -> break
    od
}

proctype thread(byte t; byte first; byte second)
{
    byte i, at, to, a, b, hi, lo, old;
    unite(t, first, second);
    true;
    d_step
    {
        ended++;
        if
        :: ended == THREADS -> check()
        :: else
        fi
    };
    ended == THREADS;
    islands_root_kernel(t + 1);
    assert(value[t + 1] == root[t + 1])
}

/* Threads are alike: their pairs need not be tried in another order. */
inline any_pair()
{
    do
    :: r < 7 -> r++
    :: break
    od;
    p = (r < 3 -> 0 : (r < 5 -> 1 : (r < 7 -> 2 : 3)));
    q = (r < 3 -> r + 1 : (r < 5 -> r - 1 : (r == 5 -> 3 : (r == 6 -> 1 : 2))));
    joined[p + 4 * q] = 1;
    joined[q + 4 * p] = 1
}

init
{
    byte p, q, r;
    begin_memory();
    atomic
    {
        value[1] = 1;
        value[2] = 2;
        value[3] = 3;
        any_pair();
        run thread(0, p, q);
        any_pair();
        run thread(1, p, q);
        any_pair();
        run thread(2, p, q)
    }
}
