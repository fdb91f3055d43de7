/* SPDX-License-Identifier: Apache-2.0 */
/* The broad phase of a scene: tree, boxes, cones, front and candidates, their
 * memory, and the order of the stages. spec/broad/broad.md */
#ifndef REF_BROAD_H
#define REF_BROAD_H

#include "ref/base/trace.h"
#include "ref/broad/apart.h"
#include "ref/broad/cones.h"
#include "ref/broad/features.h"
#include "ref/broad/front.h"
#include "ref/broad/refit.h"
#include "ref/broad/walk.h"

/* A stream that grows; what it held is lost when it does. */
struct broad_pool {
    void *data;
    int64_t cap; /* items */
};

/* Made by broad_make, then read only from outside. */
struct broad {
    struct trace *trace; /* NULL: none */
    struct arena *arena; /* the caller's; holds all memory */
    struct tree tree;
    struct tree_map map;
    int64_t nv;
    int64_t stop;  /* deferral of the front, spec/broad/front.md §5 */
    bool cones;    /* false: spec/broad/cones.md is left out */
    bool started;  /* static meshes have their boxes */
    int64_t roots; /* pairs of meshes that may touch */
    int32_t (*root)[2];
    struct box *box;
    int64_t still; /* boxes of static meshes: the first query makes them, which
                      counts as kept, so a resumed run counts as an unbroken */
    uint8_t *stir, *clear;
    int64_t n_inner; /* cloth nodes that are no leaves */
    struct tangents *tangents;
    struct apart apart; /* the host's, with a device too */

    /* Of the last broad_refit. */
    const vec *x0, *x1;
    const uint8_t *moved;
    real r;
    bool later; /* it made what moved since the one before */

    int64_t n_front;
    struct broad_pool front;          /* kept */
    struct broad_pool mask, act, sum; /* scratch */
    struct broad_pool both, kind;     /* results */
    struct broad_pool pair;           /* scratch: two streams of node pairs;
                                         then the candidates */

    int64_t n_both;                 /* triangle pairs */
    int64_t n, n_vf;                /* candidates; the first n_vf are VF */
    int64_t front_visited, visited; /* pairs of nodes looked into */

    /* Of all queries since the caller took these: boxes made, boxes that did
     * not have to be, pairs of nodes walked, and left out of it
     * as clear. */
    int queries;
    int64_t refitted, kept, walked, cleared;
};

/* The scene's streams stay the caller's: tri must live as long as b, x is not
 * kept. self: cloths see themselves and each other; a mesh of another class
 * sees itself where its own self says so, never another such mesh.
 * DRAPE_OK, DRAPE_ENOMEM or DRAPE_EARG. */
int broad_make(struct broad *b, const struct tree_scene *scene, bool self,
               struct arena *arena);

/* Whether a query would find nothing, as whole meshes are apart: then it is
 * answered. False where that cannot be told. */
int broad_ask(struct broad *b, const vec *x0, const vec *x1, real r,
              bool *apart);

/* Counts a query that whole meshes answered: without a pair. */
void broad_answer(struct broad *b);

/* Boxes and cones for a query: what comes within r on the way from x0 to x1
 * [nv], where x1 = x0 asks about one time. moved: [nv] or NULL: only pairs
 * with a vertex that moved are candidates; x0 and x1 of the others are as in
 * the query before. All three are read until the candidates are made. */
int broad_refit(struct broad *b, const vec *x0, const vec *x1, real r,
                const uint8_t *moved);

/* Moves the front to the boxes. */
int broad_update_front(struct broad *b);

/* Candidates of the front: n, n_vf, broad_pairs, broad_kinds, valid until the
 * next call. */
int broad_candidates(struct broad *b);

/* All three; where flags are given, the front stays where it is. */
int broad_query(struct broad *b, const vec *x0, const vec *x1, real r,
                const uint8_t *moved);

static inline const int32_t (*broad_pairs(const struct broad *b))[4]
{
    return (const int32_t(*)[4])b->pair.data;
}

static inline const uint8_t *broad_kinds(const struct broad *b)
{
    return (const uint8_t *)b->kind.data;
}

#endif
