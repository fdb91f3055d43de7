/* SPDX-License-Identifier: Apache-2.0 */
/* Stage energy: kinetic, elastic and of gravity. spec/cloth/energy.md */
#ifndef REF_ENERGY_H
#define REF_ENERGY_H

#include "ref/cloth/cloth.h"

struct energy {
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
    const real *mass;          /* [count] kg */
    const vec *x, *v;          /* [count] m, m/s */
    vec gravity;               /* m/s² */
    int64_t n_chunks;          /* sum_chunks(count) */
    real *chunk;               /* scratch: [3·n_chunks] */
    real value[3];             /* out: J, kinetic, elastic, of gravity */
};

/* Returns DRAPE_OK. A NaN or an overflow shows in the values. */
int ref_energy(struct energy *s);

#endif
