/* SPDX-License-Identifier: Apache-2.0 */
/* Stage impacts: the candidates that touch. spec/contact/impacts.md */
#ifndef REF_IMPACTS_H
#define REF_IMPACTS_H

#include "ref/contact/contact.h"

struct impacts {
    int64_t nv, n;       /* vertices, candidates; 4 n < 2^31 */
    const int32_t *pair; /* [n][4] v f f f or a a b b */
    const uint8_t *kind; /* [n] enum contact_kind */
    const uint32_t *toi; /* [n] floor(2^30 t) or NARROW_MISS */
    const vec *x0;       /* [nv] m, finite */
    const real *w;       /* [nv] 1/kg, ≥ 0; 0: prescribed */

    int32_t *at;       /* scratch: [n] */
    int64_t cap;       /* capacity of hit, hit_kind and hit_toi, impacts */
    int32_t *hit;      /* out: [found][4] in the candidates' order */
    uint8_t *hit_kind; /* out: [found] */
    uint32_t *hit_toi; /* out: [found] */
    int64_t found;     /* out: impacts, also if beyond cap */
    int64_t started;   /* out: pairs left out as they touch at the start, §1 */
    int64_t prescribed; /* out: pairs left out as no vertex is free, §1 */
};

/* DRAPE_OK; DRAPE_EARG for a bad vertex or kind; DRAPE_EFULL where found
 * exceeds cap: then nothing is written to hit. */
int ref_impacts(struct impacts *s);

#endif
