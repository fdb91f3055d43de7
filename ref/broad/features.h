/* SPDX-License-Identifier: Apache-2.0 */
/* Stage features: turns triangle pairs into vertex-face and edge-edge
 * candidates, each exactly once. spec/broad/features.md */
#ifndef REF_FEATURES_H
#define REF_FEATURES_H

#include "ref/base/stage.h"
#include "ref/broad/box.h"

enum { FEATURES_VF, FEATURES_EE };

struct features {
    int64_t nv, nt, n;        /* vertices, triangles, triangle pairs */
    const vec *x0, *x1;       /* [nv] m */
    int64_t n_moved;          /* nv, or 0: all vertices have moved */
    const uint8_t *moved;     /* [n_moved] not 0: the vertex has moved */
    const int32_t (*tri)[3];  /* [nt] vertices */
    int64_t n_start, n_sewn;  /* nv + 1, or 0: no vertices are sewn together */
    const int32_t *start;     /* [n_start] the list of each vertex in `sewn` */
    const int32_t *sewn;      /* [n_sewn] vertices: §5 */
    const uint8_t *own;       /* [nt] bits, spec/broad/tree.md §4 */
    const int32_t (*both)[2]; /* [n] triangles */
    real r;                   /* m, 0 ≤ r ≤ 2^60 */
    uint16_t *mask;           /* scratch: [n] bits of §1: candidates */
    int64_t *sum;             /* scratch: [2n] a count for each block */
    int64_t cap;              /* capacity for candidates */
    int32_t (*pair)[4];       /* out: [cap] v f f f, or a a, b b */
    uint8_t *kind;            /* out: [cap] 0 vertex-face, 1 edge-edge */
    int64_t n_pair, n_vf;     /* out: candidates; the first n_vf are VF */
    int64_t need;             /* out: candidates there are */
};

/* DRAPE_OK; DRAPE_EDATA for a bad r; DRAPE_EFULL: need > cap. */
int ref_features(struct features *s);

#endif
