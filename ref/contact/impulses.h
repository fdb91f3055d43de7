/* SPDX-License-Identifier: Apache-2.0 */
/* Stage impulses: impacts as contacts. spec/contact/impulses.md */
#ifndef REF_IMPULSES_H
#define REF_IMPULSES_H

#include "ref/base/keys.h"
#include "ref/broad/tree.h"
#include "ref/contact/contact.h"

/* §1 and carry.md §1.2: of the thickness, by which κ yields to a load. */
#define CONTACT_GIVE R(0.03)

struct impulses {
    int64_t nv, n;              /* vertices, impacts */
    const int32_t *pair;        /* [n][4] v f f f or a a b b */
    const uint8_t *kind;        /* [n] enum contact_kind */
    const uint32_t *toi;        /* [n] floor(2^30 t) */
    const real *w;              /* [nv] 1/kg, 0: prescribed */
    const vec *x0, *x1;         /* [nv] m, start and end of the step */
    struct surfaces surfaces;   /* of the vertices */
    struct one_rings one_rings; /* the triangles around each vertex */
    real dt;                    /* s, > 0 */
    real margin;      /* ≥ 0, part of its thickness that a pair shall keep */
    real stiffest;    /* kg, ≥ 0: no κ grows beyond; 0: none grows */
    int64_t n_active; /* size of the active set */
    const struct contact *active; /* [n_active] contacts of earlier rounds */

    int64_t n_all;           /* n + n_active */
    struct key *key, *spare; /* scratch: [n_all] */
    uint64_t *first;         /* scratch: [nv] the first impact of a vertex */
    int64_t cap;             /* capacity of contact, items */
    struct contact *contact; /* out: [found] by key, ascending */
    int64_t found;           /* out: contacts, also if beyond cap */
};

/* DRAPE_OK; DRAPE_EARG for a bad vertex, kind, dt or n_all; DRAPE_EFULL:
 * no contact is written. */
int ref_impulses(struct impulses *s);

/* §1: the key of a pair, the same in whatever order its vertices are named. */
struct key impulses_key(const int32_t v[4], int64_t kind, int64_t item);

#endif
