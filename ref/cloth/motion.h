/* SPDX-License-Identifier: Apache-2.0 */
/* Moves one cloth over a step as if nothing were in its way, by any method.
 * spec/cloth/dynamics.md */
#ifndef REF_MOTION_H
#define REF_MOTION_H

#include "ref/cloth/dynamics.h"

struct energy;

/* DRAPE_OK; DRAPE_ELIMIT if max_substeps are not stable; or what solve
 * returned. An outcome with DRAPE_DIVERGED leaves x1 = x and v1 = v. */
int motion_run(struct dynamics *s);

/* The parts of an implicit motion in which contacts take part and whose system
 * the caller solves (newton.h). MOTION_END computes the energies and undoes a
 * motion that is out of range. */
enum motion_part {
    MOTION_OPEN,
    MOTION_PLACE,
    MOTION_BALANCE,
    MOTION_LINEARISE,
    MOTION_END
};
int motion_run_part(struct dynamics *s, enum motion_part part);

/* Kinetic, elastic and gravitational energy of a state, J; uses chunk. */
void motion_energy(const struct dynamics *s, const vec *x, const vec *v,
                   double value[3]);
/* What a panel's odd cells and stars add to the elastic energy of e, J:
 * ref/panel/call.c. */
real panel_energy(const struct panel *panel, const struct energy *e);

#endif
