/* SPDX-License-Identifier: Apache-2.0 */
/* Stage wind: drag and lift of the triangles. spec/cloth/wind.md */
#ifndef REF_WIND_H
#define REF_WIND_H

#include "ref/cloth/cloth.h"

struct wind {
    int32_t m, n;        /* particles along i and j */
    int64_t count;       /* m·n */
    const uint8_t *cell; /* [count] 1: the cell with lower corner p is */
    const vec *x, *v;    /* [count] m, m/s */
    vec air;             /* m/s */
    real drag, lift;     /* kg/m³, half the air's density × coefficient */
    vec *part;           /* scratch: [2·count] N, a third of a triangle's */
    vec *force;          /* out: [count] N */
};

/* DRAPE_OK. What is not finite stays so. */
int ref_wind(struct wind *s);

#endif
