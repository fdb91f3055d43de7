/* SPDX-License-Identifier: Apache-2.0 */
/* Stage springs: the force on each particle. spec/cloth/springs.md */
#ifndef REF_SPRINGS_H
#define REF_SPRINGS_H

#include "ref/cloth/cloth.h"

struct springs {
    int32_t m, n;              /* particles along i and j */
    int64_t count;             /* m·n */
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
    const vec *x;              /* [count] m */
    int64_t n_u;               /* count, or 0: the particles are at x */
    const vec *u;              /* [n_u] m/s: they are at x + span·u, §6 */
    real span;                 /* s */
    int64_t n_v;               /* count, or 0: no damping */
    const vec *v;              /* [n_v] m/s */
    int64_t n_wind;            /* count, or 0: no wind */
    const vec *wind;           /* [n_wind] N */
    vec gravity;               /* m/s² */
    vec *force;                /* out: [count] N */
};

/* Returns DRAPE_OK. Values that are not finite propagate. */
int ref_springs(struct springs *s);

#endif
