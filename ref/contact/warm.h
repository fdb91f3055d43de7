/* SPDX-License-Identifier: Apache-2.0 */
/* Stage warm: the push of the contacts that the next slice starts with.
 * spec/contact/warm.md */
#ifndef REF_WARM_H
#define REF_WARM_H

#include "ref/contact/contact.h"

struct warm {
    int64_t nv, n;           /* vertices, contacts; 4 n < 2^31 */
    const real *w;           /* [nv] 1/kg, ≥ 0; 0: led */
    const vec *g;            /* [nv] N·s, contacts' impulse on free vertices */
    const vec *v;            /* [nv] m/s, when the slice began */
    struct contact *contact; /* [n] as penalty held them; out: impulse */
    const vec *before;       /* [nv] N, press of the slice before */
    real part;               /* 1/s: press = part · impulse, §3 */
    real again;              /* s: bound of an impulse = again · before … */
    real speed;              /* m/s: … + speed / w, §2 */

    int64_t nv1, n4;      /* nv + 1, 4 n */
    const int32_t *start; /* [nv1] lists of contacts.md §1 */
    const int32_t *item;  /* [n4] */
    real *all;            /* scratch: [nv] Σ |c| of held contacts, §1 */
    vec *press;           /* out: [nv] N, 0 where no contact is held */
};

/* DRAPE_OK. */
int ref_warm(struct warm *s);

#endif
