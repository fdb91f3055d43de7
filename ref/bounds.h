/* SPDX-License-Identifier: Apache-2.0 */
/* Stage bounds: the box that each vertex sweeps. spec/20_bounds.md */
#ifndef REF_BOUNDS_H
#define REF_BOUNDS_H

#include "ref/stage.h"

struct bounds {
    int64_t n;          /* vertices */
    const vec *x0, *x1; /* [n] m, start and end of the step, |x| ≤ 2^60 */
    real r;             /* m, 0 ≤ r ≤ 2^60 */
    vec *lo, *hi;       /* out: [n] m */
};

/* DRAPE_OK, or DRAPE_EDATA if r or a position is NaN or out of range. */
int ref_bounds(struct bounds *s);

#endif
