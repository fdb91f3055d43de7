/* SPDX-License-Identifier: Apache-2.0 */
/* The broad phase of a scene: the BVH, its boxes and cones, the BVTT front, the
 * candidates, and the memory of them all. spec/broad/broad.md */
#ifndef REF_BROAD_H
#define REF_BROAD_H

#include "ref/base/backend.h"
#include "ref/broad/apart.h"
#include "ref/broad/tree.h"

struct box;
struct tangents;

/* broad_make fills this struct. Other files only read its members. */
struct broad {
    const struct backend *run;
    struct gpu *on;      /* the first argument of the backend's functions */
    struct trace *trace; /* NULL: none */
    struct tree tree;
    struct tree_map map;
    int64_t nv;
    int64_t stop;  /* highest level that the front does not split,
                      spec/broad/front.md §5 */
    bool cones;    /* false: stage cones is not run */
    bool started;  /* the boxes of static meshes are made */
    bool restless; /* a static mesh moves: its boxes are made in each query
                      that refits all boxes */
    int64_t roots; /* root pairs: meshes that are compared */
    int32_t (*root)[2];
    struct box *box;
    int64_t still; /* number of boxes of static meshes; the first query makes
                      them but counts them as kept, so that a resumed run has
                      the same counters as an unbroken run */
    uint8_t *stir, *clear;
    const uint8_t *awake; /* [nv] of the caller's: a query without `moved` finds
                             only pairs with a vertex whose flag is set, and all
                             others stay where they are; NULL: all are awake */
    int64_t n_start, n_sewn; /* the caller's lists of features.md §5, 0: none */
    const int32_t *start, *sewn;
    bool made;       /* since `awake` was set: boxes of the others */
    int64_t n_inner; /* inner nodes of cloth */
    struct tangents *tangents;
    struct apart apart; /* on the host */

    /* Arguments of the last query. */
    const vec *x0, *x1;
    const uint8_t *moved;
    real r;
    bool later; /* only boxes of moved vertices were refitted */
    bool dozes; /* it looked at what `awake` names */

    int64_t n_front;
    struct pool front;          /* lives from query to query */
    struct pool mask, act, sum; /* scratch */
    struct pool both, kind;     /* results */
    struct pool pair;           /* scratch: two streams of node pairs;
                                         then the candidates */

    int64_t n_both;                 /* triangle pairs */
    int64_t n, n_vf;                /* candidates; the first n_vf are
                                       vertex-face */
    int64_t front_visited, visited; /* node pairs tested */

    /* Work counters, summed over all queries until the caller resets them:
     * queries, boxes refitted, boxes kept, node pairs visited by the walk, and
     * node pairs that only the cones rejected. */
    int queries;
    int64_t refitted, kept, walked, cleared;
};

/* Builds the broad phase of a scene. The caller keeps the scene's streams:
 * scene->tri must live as long as b, scene->x is not kept. With `self`, cloths
 * are tested against themselves and each other. A mesh of another class is
 * tested against itself where its own `self` is set, and never against another
 * mesh that is not cloth. The arena is the caller's and holds all memory.
 * Returns DRAPE_OK, DRAPE_ENOMEM or DRAPE_EARG. gpu_broad_make makes a device's
 * of it.
 */
int broad_make(struct broad *b, const struct tree_scene *scene, bool self,
               struct arena *arena);

/* Sets *apart where whole meshes are so far apart that the query has no
 * candidates. The query is then complete: it is counted by broad_count_empty
 * and no other call is needed. *apart is false where this cheap test cannot
 * tell. */
int broad_meshes_apart(struct broad *b, const vec *x0, const vec *x1, real r,
                       bool *apart);

/* Counts a query that broad_meshes_apart has settled, and sets its candidates
 * to none. */
void broad_count_empty(struct broad *b);

/* Finds the features that come within r of each other on the way from x0 to
 * x1 [nv]; x1 = x0 queries one time. With `moved` [nv], only pairs with a
 * vertex whose flag is set become candidates, and x0 and x1 of every other
 * vertex must be as in the query before; NULL means that all vertices moved.
 * The candidates are n and n_vf, broad_pairs and broad_kinds; they are valid
 * until the next call. Where `moved` is given after a first full query, the
 * front is not moved: a front anywhere gives the same candidates
 * (spec/broad/walk.md §3). */
int broad_query(struct broad *b, const vec *x0, const vec *x1, real r,
                const uint8_t *moved);

/* Resets the front to the root pairs, with a capacity of `need` pairs. */
int broad_begin_front(struct broad *b, int64_t need);

static inline const int32_t (*broad_pairs(const struct broad *b))[4]
{
    return (const int32_t(*)[4])b->pair.data;
}

static inline const uint8_t *broad_kinds(const struct broad *b)
{
    return (const uint8_t *)b->kind.data;
}

#endif
