/* SPDX-License-Identifier: Apache-2.0 */
/* Stage tension: the elastic energy of fibres and stars.
 * spec/panel/tension.md */
#ifndef REF_TENSION_H
#define REF_TENSION_H

#include "ref/panel/lists.h"

struct tension {
    int64_t count;                  /* particles */
    int64_t laws;                   /* SPRINGS */
    const struct law *law;          /* [laws] */
    int64_t pieces;                 /* PIECES, or 0: no tension was measured */
    const struct piece *piece;      /* [pieces] */
    int64_t n_cells;                /* odd cells */
    const int32_t (*corner)[4];     /* [n_cells] particles */
    const struct fibre (*fibre)[6]; /* [n_cells] */
    int64_t n_stars;
    const struct star *star; /* [n_stars] */
    const vec *x;            /* [count] m */
    int64_t n_chunks;        /* sum_chunks(n_cells + n_stars) */
    real *chunk;             /* scratch: [n_chunks] */
    real value;              /* out: J */
};

/* Returns DRAPE_OK. A NaN or an overflow shows in the value. */
int ref_tension(struct tension *s);

#endif
