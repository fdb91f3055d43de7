/* SPDX-License-Identifier: Apache-2.0 */
/* Stage joins: adds the blocks of fibres and stars. spec/panel/joins.md */
#ifndef REF_JOINS_H
#define REF_JOINS_H

#include "ref/panel/lists.h"

struct joins {
    int64_t count;                  /* particles */
    int64_t laws;                   /* SPRINGS */
    const struct law *law;          /* [laws] */
    int64_t pieces;                 /* PIECES, or 0: no tension was measured */
    const struct piece *piece;      /* [pieces] */
    int64_t n_cells;                /* odd cells */
    const int32_t (*corner)[4];     /* [n_cells] particles */
    const struct fibre (*fibre)[6]; /* [n_cells] */
    int64_t n_pairs;
    const int32_t *first;     /* [n_pairs] particle */
    const uint8_t *way;       /* [n_pairs] forward direction */
    const real *bend;         /* [n_pairs] N/m */
    const int32_t (*from)[2]; /* [n_pairs] into join; -1: none */
    const vec *x;             /* [count] m */
    int64_t n_q;              /* count, or 0: directions are those at x */
    const vec *q;             /* [n_q] m/s, the motion predicted for tau */
    real tau;                 /* s, > 0 */
    int64_t n_join;           /* CELL_PAIRS·n_cells */
    sym *join;                /* scratch: [n_join] kg */
    int64_t n_blocks;         /* SPRINGS·count */
    sym *block;               /* inout: [n_blocks] kg */
};

/* Returns DRAPE_OK. Values that are not finite propagate. */
int ref_joins(struct joins *s);

#endif
