/* SPDX-License-Identifier: Apache-2.0 */
/* Stage links: the contacts' own matrix times a vector.
 * spec/contact/penalty.md §3 */
#ifndef REF_LINKS_H
#define REF_LINKS_H

#include "ref/contact/contact.h"

struct links {
    int64_t nv, n;                 /* vertices, contacts; 4 n < 2^31 */
    const struct contact *contact; /* [n] v, c, n, held, along,
                                      slide */
    real across;                   /* ≥ 0: tau/dt, by which slide counts */
    const vec *x;                  /* [nv] m/s, 0 where w is 0 */

    int64_t nv1, n4;      /* nv + 1, 4 n */
    const int32_t *start; /* [nv1] first item of a vertex, contacts.md §1 */
    const int32_t *item;  /* [n4] 4·contact + corner, by vertex */
    vec *push;            /* scratch: [n] N·s */
    vec *y;               /* inout: [nv] N·s, gains the matrix times x */
};

/* DRAPE_OK, or DRAPE_EARG for counts that do not fit. */
int ref_links(struct links *s);

#endif
