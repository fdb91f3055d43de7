/* SPDX-License-Identifier: Apache-2.0 */
/* Stage narrow: whether and when two moving primitives first touch, exactly.
 * spec/narrow/narrow.md */
#ifndef REF_NARROW_H
#define REF_NARROW_H

#include "ref/base/real.h"

#define NARROW_MISS UINT32_MAX /* no contact in [0, 1] */
#define NARROW_ONE (1u << 30)  /* t = 1 */

struct narrow {
    int64_t n;           /* pairs */
    const int32_t *pair; /* [n][4] vertices: v, f f f or a a, b b */
    const uint8_t *kind; /* [n] 0 vertex-face, 1 edge-edge */
    const vec *x0, *x1;  /* [nv] positions at t = 0 and t = 1, m */
    int64_t nv;
    uint32_t *toi; /* out: [n] floor(2^30 t) of the first contact, or
                      NARROW_MISS */
    uint8_t *tier; /* out: [n] 1 to 3, the tier that settled the pair */
};

/* Return floor(2^30 t) of the first contact or NARROW_MISS, and set *tier to
 * the tier that decided. Positions must be finite. */
uint32_t narrow_vf(const vec x0[4], const vec x1[4], int *tier);
uint32_t narrow_ee(const vec x0[4], const vec x1[4], int *tier);

/* DRAPE_OK, or DRAPE_EDATA where a position is not finite, or a vertex number
 * or a kind is out of range. */
int ref_narrow(struct narrow *s);

#endif
