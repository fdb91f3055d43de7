/* SPDX-License-Identifier: Apache-2.0 */
/* Stage pull: adds the forces of fibres and stars. spec/panel/pull.md */
#ifndef REF_PULL_H
#define REF_PULL_H

#include "ref/panel/lists.h"

struct pull {
    int64_t count;                  /* particles */
    int32_t m;                      /* particles along i */
    int64_t laws;                   /* SPRINGS */
    const struct law *law;          /* [laws] */
    int64_t pieces;                 /* PIECES, or 0: no tension was measured */
    const struct piece *piece;      /* [pieces] */
    int64_t n_cells;                /* odd cells */
    const int32_t (*corner)[4];     /* [n_cells] particles */
    const struct fibre (*fibre)[6]; /* [n_cells] */
    int64_t n_pairs;
    const real *bend; /* [n_pairs] N/m */
    int64_t n_parts;
    const int32_t *part;      /* [n_parts] particles, each once */
    const int32_t (*push)[4]; /* [n_parts] into pushes; -1: none */
    const int32_t (*tie)[16]; /* [n_parts] into bend; -1: none */
    const vec *x;             /* [count] m */
    int64_t n_u;              /* count, or 0: the particles are at x */
    const vec *u;             /* [n_u] m/s: they are at x + span·u */
    real span;                /* s */
    int64_t n_v;              /* count, or 0: no damping */
    const vec *v;             /* [n_v] m/s */
    int64_t n_pushes;         /* CORNERS·n_cells */
    vec *pushes;              /* scratch: [n_pushes] N */
    vec *force;               /* inout: [count] N */
};

/* Returns DRAPE_OK. Values that are not finite propagate. */
int ref_pull(struct pull *s);

#endif
