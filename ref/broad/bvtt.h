/* SPDX-License-Identifier: Apache-2.0 */
/* The bounding-volume test tree (BVTT), which stages front and walk traverse:
 * its nodes are pairs of BVH nodes. This header says when a pair passes, which
 * children a pair has, and how streams of pairs are counted.
 * spec/broad/front.md */
#ifndef REF_BVTT_H
#define REF_BVTT_H

#include "ref/broad/box.h"
#include "ref/broad/tree.h"

/* Items of a stream that are counted and written together. */
enum { BVTT_BLOCK = 256 };

/* Inputs that front and walk share. */
struct bvtt {
    struct tree tree;
    const struct box *box; /* [tree.n] m */
    const uint8_t *clear;  /* [tree.n_cloth] spec/broad/cones.md §5 */
    real r;                /* m, reach of the query, 0 ≤ r ≤ 2^60 */
};

/* Bit numbers of `clear`. A set bit says that a node cannot touch itself (SELF)
 * or its neighbour in that direction. */
enum { CLEAR_SELF, CLEAR_E, CLEAR_NE, CLEAR_N, CLEAR_NW, CLEAR_ALL = 31 };

/* §4: whether the cones prove that two cloth nodes of one level cannot touch.
 * Nodes that are neighbours have a bit of their own. Nodes further apart
 * inherit the bit of their lowest ancestors that are neighbours or one node. */
static inline bool bvtt_clear(const struct bvtt *s, int32_t a, int32_t b)
{
    const struct tree *t = &s->tree;
    if (a >= t->n_cloth || b >= t->n_cloth || t->mesh[a] != t->mesh[b])
        return false;
    int di, dj;
    for (;;) {
        di = (t->place[b] & 0xffff) - (t->place[a] & 0xffff);
        dj = (t->place[b] >> 16) - (t->place[a] >> 16);
        if (di >= -1 && di <= 1 && dj >= -1 && dj <= 1)
            break;
        a = t->parent[a];
        b = t->parent[b];
    }
    bool swapped = dj < 0 || (dj == 0 && di < 0);
    di = swapped ? -di : di;
    /* Directions (0,0) (1,0) (1,1) (0,1) (-1,1) have bits 0 to 4. */
    return s->clear[swapped ? b : a] >> (dj == 0 ? di : 3 - di) & 1;
}

static inline bool bvtt_meets(const struct bvtt *s, real reach, int32_t a,
                              int32_t b)
{
    return a == b || box_meets(&s->box[a], &s->box[b], reach);
}

/* §2: whether a pair passes, so that its children must be tested. */
static inline bool bvtt_passes(const struct bvtt *s, real reach, int32_t a,
                               int32_t b)
{
    return bvtt_meets(s, reach, a, b) && !bvtt_clear(s, a, b);
}

/* The children of a pair are numbered 4 i + j for child i of a and child j of
 * b. Returns a mask in which bit 4 i + j is set if there is such a child.
 * `descends` is from tree_descends. */
static inline uint32_t bvtt_children(const struct tree *t, int descends,
                                     int32_t a, int32_t b)
{
    int na = descends & 1 ? t->count[a] : 1;
    int nb = descends & 2 ? t->count[b] : 1;
    uint32_t mask = 0;
    for (int i = 0; i < na; i++)
        for (int j = a == b ? i : 0; j < nb; j++)
            mask |= 1u << (4 * i + j);
    return mask;
}

static inline void bvtt_child(const struct tree *t, int descends, int k,
                              int32_t *a, int32_t *b)
{
    *a = descends & 1 ? t->first[*a] + (k >> 2) : *a;
    *b = descends & 2 ? t->first[*b] + (k & 3) : *b;
}

static inline int bvtt_bits(uint32_t mask)
{
    int n = 0;
    for (; mask; mask &= mask - 1)
        n++;
    return n;
}

static inline int64_t bvtt_blocks(int64_t n)
{
    return (n + BVTT_BLOCK - 1) / BVTT_BLOCK;
}

/* Turns the counts of n blocks into the place where each block begins (an
 * exclusive prefix sum). Returns the total. */
static inline int64_t bvtt_scan(int64_t *sum, int64_t n)
{
    int64_t at = 0;
    for (int64_t k = 0; k < n; k++) {
        int64_t here = sum[k];
        sum[k] = at;
        at += here;
    }
    return at;
}

#endif
