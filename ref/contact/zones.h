/* SPDX-License-Identifier: Apache-2.0 */
/* Stage zones: pairs that still touch move as rigid bodies.
 * spec/contact/zones.md */
#ifndef REF_ZONES_H
#define REF_ZONES_H

#include "ref/base/keys.h"
#include "ref/contact/contact.h"

/* The sums of a zone, or a member's share of them, §2. */
struct zone_sum {
    real m;   /* kg, or a count of prescribed members */
    vec a, b; /* Σ m x, Σ m u; then a = L */
    sym i;    /* kg·m², inertia */
};

struct zone {
    int64_t first, end; /* its members in the sorted list */
    bool prescribed;    /* the zone has a prescribed member */
    vec base;           /* m, position of the first member */
    vec centre;         /* m, of mass, relative to base */
    vec velocity;       /* m/s */
    vec spin;           /* 1/s */
};

struct zones {
    int64_t nv, n;       /* vertices, pairs; 4 n < 2^31 */
    const int32_t *pair; /* [n][4] pairs that touched since impulses ended */
    const real *w;       /* [nv] 1/kg, ≥ 0; 0: prescribed */
    const vec *x0;       /* [nv] m, start of the step */
    real dt;             /* s, > 0 */
    vec *u;              /* in, out: [nv] m/s mean velocity of the step */

    int64_t n4;              /* 4 n */
    int32_t *label;          /* scratch: [nv] */
    struct key *key, *spare; /* scratch: [n4] */
    struct zone_sum *sum;    /* scratch: [n4] */
    struct zone *zone;       /* scratch: [n] */
    int32_t *vertex;         /* out: [n4] free vertices of zones, by zone */
    int64_t vertices;        /* out: length of vertex */
    int64_t found;           /* out: zones */
};

/* DRAPE_OK, or DRAPE_EARG for a bad vertex, dt or n4. */
int ref_zones(struct zones *s);

#endif
