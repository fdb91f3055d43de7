/* SPDX-License-Identifier: Apache-2.0 */
/* Stages moments, islands and spin: what bodies in empty space keep of their
 * momentum. spec/momentum/momentum.md */
#ifndef REF_MOMENTUM_H
#define REF_MOMENTUM_H

#include "ref/contact/contact.h"

/* §1: the sums of stage moments: of mass; of m d; of m e; of m d × e; of the
 * six numbers xx, xy, xz, yy, yz, zz of m d dᵀ; of m e·e. */
enum {
    MOMENT_MASS,
    MOMENT_PLACE,
    MOMENT_SPEED = 4,
    MOMENT_SPIN = 7,
    MOMENT_SPREAD = 10,
    MOMENT_SQUARE = 16,
    MOMENTS
};

struct moments {
    int64_t count;       /* particles, ≥ 1 */
    const real *w;       /* [count] 1/kg; 0: counts as without mass */
    const vec *x, *v;    /* [count] m, m/s */
    int64_t n_chunks;    /* sum_chunks(count) */
    real *chunk;         /* scratch: [MOMENTS·n_chunks] */
    vec at, speed;       /* out: m, m/s of particle count / 2 */
    real value[MOMENTS]; /* out: with d = x - at and e = v - speed */
};

struct islands {
    int64_t nv, n;                 /* vertices, contacts */
    const uint16_t *body;          /* [nv] */
    const struct contact *contact; /* [n] */
    int64_t bodies; /* those of greater number, obstacles, join nothing */
    int32_t *label; /* out: [bodies] the first body of its island, §2 */
};

struct spin {
    int64_t count; /* particles */
    const real *w; /* [count] 1/kg; 0: keeps its velocity */
    const vec *x;  /* [count] m */
    real keep;
    vec centre;   /* m */
    vec dv, dw;   /* m/s, 1/s */
    const vec *v; /* [count] m/s */
    vec *to;      /* out: [count] m/s, keep v + dv + dw × (x - centre);
                     may be v */
};

/* All return DRAPE_OK, islands DRAPE_EARG for a vertex that is not there. A NaN
 * or an overflow shows in the values. */
int ref_moments(struct moments *s);
int ref_islands(struct islands *s);
int ref_spin(struct spin *s);

#endif
