/* SPDX-License-Identifier: Apache-2.0 */
/* The unknowns of a slice with contacts: memory, and how a solve moves them, by
 * the reference. spec/contact/lagrange.md */
#ifndef REF_UNKNOWNS_H
#define REF_UNKNOWNS_H

#include "ref/contact/carry.h"

struct world;

/* Moves the particles of all cloths along dv. All streams are [count]. */
struct shift {
    int64_t count;
    const real *w;    /* 1/kg, 0: fixed */
    const vec *x0;    /* m */
    const vec *dv;    /* m/s */
    real part;        /* of dv */
    real span, dt;    /* tau / dt; s */
    vec *u, *v, *x1;  /* inout: u += span·part·dv, v += part·dv; out: x1 */
    uint8_t *touched; /* out: 1 where w > 0 */
};

/* §5: the change of each particle's velocity by the contacts that struck. */
struct jumps {
    int64_t count;
    const real *w;                 /* [count] 1/kg, 0: fixed */
    const struct contact *contact; /* [n] */
    const struct kept *kept;       /* [n] of stage retain: 0 where it struck */
    const int32_t *start, *item;   /* their lists, of stage coulomb */
    const vec *rest; /* [count] N·s, what the contacts had to balance */
    vec *push; /* out: [count] N·s, the impulse of contacts that struck it,
                  less their part of what all leave undone; may be rest */
};

/* Takes the streams of w->lagrange. DRAPE_OK or DRAPE_ENOMEM. */
int unknowns_make(struct world *w);

#endif
