/* SPDX-License-Identifier: Apache-2.0 */
/* Stage rollback: vertices go back to the start of the step, where nothing
 * touches. spec/contact/rollback.md */
#ifndef REF_ROLLBACK_H
#define REF_ROLLBACK_H

#include "ref/contact/contact.h"

struct rollback {
    int64_t nv, n;       /* vertices, pairs */
    const int32_t *pair; /* [n][4] the pairs that touch */
    const real *w;       /* [nv] 1/kg, ≥ 0; 0: prescribed */
    const vec *x0;       /* [nv] m, start of the step */
    int all;             /* 1: if any vertex goes back, all free ones do */
    vec *x1;             /* in, out: [nv] m, end of the step */
    vec *u, *v;          /* in, out: [nv] m/s, mean and end velocity */
    uint8_t *rolled;     /* in, out: [nv] 1: was rolled back in this step */
    uint8_t *touched;    /* out: [nv] 1: was rolled back in this call */
    int64_t grown;       /* out: vertices rolled back in this call */
    int64_t trapped;     /* out: pairs without a free vertex to roll back */
};

/* DRAPE_OK, or DRAPE_EARG for a bad vertex. */
int ref_rollback(struct rollback *s);

#endif
