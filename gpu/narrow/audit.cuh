/* SPDX-License-Identifier: Apache-2.0 */
/* Declarations that the source files of stage audit on the device share.
 * spec/narrow/audit.md §4 */
#ifndef GPU_AUDIT_CUH
#define GPU_AUDIT_CUH

#include "gpu/base/real.cuh"
#include "gpu/base/wide.cuh"

extern "C" {
#include "ref/narrow/audit.h"
}

enum { AUDIT_LEVELS = 17 };
enum { AUDIT_BAD_PLACE = 1, AUDIT_BAD_NAME = 2 };

/* The words of gpu_words in this stage. */
enum {
    AUDIT_BAD,          /* faults of the input */
    AUDIT_FIXED,        /* triangles of group 0 */
    AUDIT_FLAT,         /* degenerate triangles */
    AUDIT_ORIENTATIONS, /* triangles that need integer arithmetic */
    AUDIT_LEFT,         /* pairs that no filter decides */
    AUDIT_UNSURE,       /* pairs that need integer arithmetic */
    AUDIT_HITS,         /* pairs that intersect */
    AUDIT_HIGH,         /* [6] largest x y z -x -y -z, as ordered integers */
    AUDIT_WORDS = AUDIT_HIGH + 6
};

/* §4.2: level l has count[l] boxes, four a node, from node at[l] on. The boxes
 * of level 0 are those of the triangles in order; level `top` has one node. */
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

/* Records a fault of the input. */
static __device__ inline void audit_bad(int64_t *word, int fault)
{
    atomicOr((unsigned *)&word[AUDIT_BAD], (unsigned)fault);
}

/* Returns the next place of a list. The order of a list does not affect the
 * result. */
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

/* Checks every position and computes the box of all positions. */
void gpu_audit_check(struct gpu *g, struct audit *s, int64_t *word);
/* Sorts the triangles and builds the tree over them, after gpu_audit_check and
 * with word[AUDIT_FIXED] complete. After a fault the order and the tree must
 * not be used. */
void gpu_audit_tree(struct gpu *g, struct audit *s,
                    const struct audit_levels *l, const int64_t *word);
/* Writes s->pair, ascending, from `found` hits stored as first triangle · 2^32
 * + second. */
void gpu_audit_pairs(struct gpu *g, struct audit *s, const uint64_t *hit);

#endif
