/* SPDX-License-Identifier: Apache-2.0 */
/* Mass, momentum and inertia of bodies and of islands of them, on the host.
 * spec/momentum/momentum.md §3 */
#ifndef REF_TALLY_H
#define REF_TALLY_H

#include "ref/momentum/momentum.h"

/* Of a body or an island. */
struct tally {
    double mass;      /* kg */
    double centre[3]; /* m */
    double p[3];      /* N·s */
    double l[3];      /* N·m·s about the centre */
    double spread[6]; /* kg·m², Σ m r rᵀ about it: xx, xy, xz, yy, yz, zz */
    double kinetic;   /* J, of what moves relative to the centre */
    double elastic;   /* J, set by the caller */
};

/* What velocities v become: keep v + dv + dw × r, r from the centre. */
struct gain {
    double keep;
    double centre[3]; /* m */
    double dv[3];     /* m/s */
    double dw[3];     /* 1/s */
};

/* Returns the tally of one body. */
struct tally tally_of(const struct moments *s);
/* Joins n bodies: island[k] becomes the tally of the island of those with of[i]
 * = k, for each k that is one. */
void tally_join(int n, const int32_t *of, const struct tally *part,
                struct tally *island);
/* Returns the gain by which `after` has the momentum p and, as far as the
 * energy of `before` allows, the angular momentum of `before`. */
struct gain tally_gain(const struct tally *before, const struct tally *after,
                       const double p[3]);

#endif
