/* SPDX-License-Identifier: Apache-2.0 */
/* Stage wind: drag and lift of the triangles, and what they add to the inertia
 * of an implicit step. spec/cloth/wind.md */
#ifndef REF_WIND_H
#define REF_WIND_H

#include "ref/cloth/cloth.h"

struct wind {
    int32_t m, n;        /* particles along i and j */
    int64_t count;       /* m·n */
    const uint8_t *cell; /* [count] 1: cell with lower corner p is present */
    const vec *x, *v;    /* [count] m, m/s */
    vec air;             /* m/s, velocity of the air */
    real drag, lift;     /* kg/m³, half the air's density × coefficient */
    real tau;            /* s, of an implicit step; §3 */
    int64_t n_inertia;   /* count, or 0: the step is explicit */
    const real *mass;    /* [n_inertia] kg */
    int64_t n_cells;     /* odd cells of a panel, which `cell` has not; §4 */
    const int32_t (*corner)[4]; /* [n_cells] particles; of a triangle the last
                                   is the first again */
    int64_t n_parts;            /* particles that may have odd cells */
    const int32_t *owner;       /* [n_parts] particles, each once */
    const int32_t (*push)[4];   /* [n_parts] 4·cell + corner of its odd cells;
                                   -1: none */
    vec (*load)[2]; /* scratch: [n_cells] what each corner of an odd cell
                       gets, N, and in x its resistance, kg/s */
    vec *part;      /* scratch: [2·count] N, a third of each triangle's
                       force */
    real *rate;     /* scratch: [2·n_inertia] kg/s, a third of each
                       triangle's resistance */
    vec *force;     /* out: [count] N */
    real *inertia;  /* out: [n_inertia] kg, mass + tau·resistance */
};

/* Returns DRAPE_OK. Values that are not finite propagate. */
int ref_wind(struct wind *s);

#endif
