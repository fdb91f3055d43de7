/* SPDX-License-Identifier: Apache-2.0 */
/* What the halves of stage audit on the device share. spec/narrow/audit.md §4
 */
#ifndef GPU_AUDIT_CUH
#define GPU_AUDIT_CUH

#include "gpu/base/real.cuh"
#include "gpu/base/wide.cuh"

extern "C" {
#include "ref/narrow/audit.h"
}

enum { AUDIT_LEVELS = 17 };
enum { AUDIT_BAD_PLACE = 1, AUDIT_BAD_NAME = 2 };

/* Words of gpu_words. */
enum {
    AUDIT_BAD,    /* faults of the input */
    AUDIT_FIXED,  /* triangles of group 0 */
    AUDIT_FLAT,   /* degenerate triangles */
    AUDIT_TURNS,  /* triangles whose turn needs whole numbers */
    AUDIT_LEFT,   /* pairs that the filters leave */
    AUDIT_UNSURE, /* pairs of these that need whole numbers */
    AUDIT_HITS,   /* pairs that intersect */
    AUDIT_HIGH,   /* [6] the largest x y z -x -y -z, as whole numbers */
    AUDIT_WORDS = AUDIT_HIGH + 6
};

/* §4.2: level l has count[l] boxes, four a node, from node at[l] on; level 0
 * are the triangles in order, level `top` has one node. */
struct audit_levels {
    int64_t at[AUDIT_LEVELS];
    int32_t count[AUDIT_LEVELS];
    int top;
};

struct audit_span {
    vec lo, hi;
};

static __device__ inline struct audit_span audit_lane(const struct audit *s,
                                                      int64_t at, int32_t b)
{
    const struct audit_quad *q = &s->node[at + b / 4];
    int j = b % 4;
    return audit_span{make(q->lo[0][j], q->lo[1][j], q->lo[2][j]),
                      make(q->hi[0][j], q->hi[1][j], q->hi[2][j])};
}

/* Notes a fault. */
static __device__ inline void audit_bad(int64_t *word, int fault)
{
    atomicOr((unsigned *)&word[AUDIT_BAD], (unsigned)fault);
}

/* The next place of a list; its order does not show. */
static __device__ inline int64_t audit_next(int64_t *word)
{
    return (int64_t)atomicAdd((unsigned long long *)word, 1ull);
}

static __device__ inline bool in_mesh(const int32_t v[3], int64_t nv)
{
    return v[0] >= 0 && v[0] < nv && v[1] >= 0 && v[1] < nv && v[2] >= 0 &&
           v[2] < nv;
}

struct audit_levels gpu_audit_levels(int64_t nt);

/* Looks at every position, for faults and the box of all. */
void gpu_audit_look(struct gpu *g, struct audit *s, int64_t *word);
/* The order of triangles and the tree over it; after the look and with n_fixed
 * known. Nothing of it is to be used where there was a fault. */
void gpu_audit_tree(struct gpu *g, struct audit *s,
                    const struct audit_levels *l, const int64_t *word);
/* s->pair from `found` hits, first triangle · 2^32 + second, ascending. */
void gpu_audit_pairs(struct gpu *g, struct audit *s, const uint64_t *hit);

#endif
