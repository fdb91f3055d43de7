/* SPDX-License-Identifier: Apache-2.0 */
/* Stage blocks: the springs' part of the implicit matrix.
 * spec/cloth/blocks.md */
#ifndef REF_BLOCKS_H
#define REF_BLOCKS_H

#include "ref/base/packed.h"
#include "ref/cloth/cloth.h"

/* §8: half of the largest rotation that a spring is followed through, rad. */
#define BLOCKS_ROTATION 0.025

struct blocks {
    int64_t count;             /* particles */
    int32_t m;                 /* particles along i */
    int64_t laws;              /* SPRINGS */
    const struct law *law;     /* [laws] */
    int64_t pieces;            /* PIECES, or 0: no tension was measured */
    const struct piece *piece; /* [pieces] */
    const uint8_t *springs;    /* [count] bit o: forward spring o is present */
    int64_t triples;           /* TRIPLES, or 0: springs resist bending */
    const real *triple;        /* [triples] N/m, constants of triples */
    int64_t n_beside;          /* count, or 0 likewise */
    const uint8_t *beside;     /* [n_beside] bits of the cells about p */
    const vec *x;              /* [count] m */
    int64_t n_q;               /* count, or 0: directions are those at x */
    const vec *q;              /* [n_q] m/s, the motion predicted for tau */
    real tau;                  /* s, > 0 */
    sym *block; /* out: [SPRINGS·count] kg, spring o of p at o·count + p */
    int64_t n_packed;      /* SPRINGS·count, or 0: no packed blocks */
    struct packed *packed; /* out: [n_packed] the same blocks in 64 bits, §5 */
};

/* Returns DRAPE_OK. Values that are not finite propagate. */
int ref_blocks(struct blocks *s);

#endif
