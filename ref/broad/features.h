/* SPDX-License-Identifier: Apache-2.0 */
/* Stage features: from pairs of triangles to vertex-face and edge-edge
 * candidates, each once. spec/broad/features.md */
#ifndef REF_FEATURES_H
#define REF_FEATURES_H

#include "ref/base/stage.h"
#include "ref/broad/box.h"

enum { FEATURES_VF, FEATURES_EE };

struct features {
    int64_t nv, nt, n;        /* vertices, triangles, triangle pairs */
    const vec *x0, *x1;       /* [nv] m */
    int64_t n_moved;          /* nv, or 0: all have moved */
    const uint8_t *moved;     /* [n_moved] */
    const int32_t (*tri)[3];  /* [nt] vertices */
    const uint8_t *own;       /* [nt] spec/broad/tree.md §4 */
    const int32_t (*both)[2]; /* [n] triangles */
    real r;                   /* m, 0 ≤ r ≤ 2^60 */
    uint16_t *mask;           /* scratch: [n] feature pairs that meet */
    int64_t *sum;             /* scratch: [2n] counts of blocks */
    int64_t cap;              /* room for candidates */
    int32_t (*pair)[4];       /* out: [cap] v f f f, or a a, b b */
    uint8_t *kind;            /* out: [cap] 0 vertex-face, 1 edge-edge */
    int64_t n_pair, n_vf;     /* out: candidates; the first n_vf are VF */
    int64_t need;             /* out: candidates that there are */
};

/* DRAPE_OK; DRAPE_EDATA for a bad r; DRAPE_EFULL: need > cap. */
int ref_features(struct features *s);

#endif
