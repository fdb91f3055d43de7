/* SPDX-License-Identifier: Apache-2.0 */
/* Moves one cloth over a step as if nothing were in its way, by any method.
 * spec/cloth/dynamics.md */
#ifndef REF_MOTION_H
#define REF_MOTION_H

#include "ref/cloth/dynamics.h"

/* DRAPE_OK; DRAPE_ELIMIT if max_substeps are not stable; or what solve
 * returned. An outcome with DRAPE_DIVERGED leaves x1 = x and v1 = v. */
int ref_motion(struct dynamics *s);

/* The same in two parts, of a linearly implicit motion whose system the caller
 * solves (newton.h): open sets the matrix and b, close takes dv [count]. */
int ref_motion_open(struct dynamics *s);
int ref_motion_close(struct dynamics *s, vec *dv);

/* Kinetic, elastic and gravitational energy of a state, J; uses chunk. */
void motion_energy(const struct dynamics *s, const vec *x, const vec *v,
                   double value[3]);

#endif
