/* SPDX-License-Identifier: Apache-2.0 */
/* A point that slides on a ground, and where it does so for long enough.
 * spec/validation.md §9 */
#ifndef VALIDATE_PATH_H
#define VALIDATE_PATH_H

#include "ci/validate/ground.h"

enum { PATHS = 3 };
static const double PATH_SECONDS = 0.25, PATH_GRAVITY = 9.81;

/* A point of mass 1 kg. */
struct point {
    double x[3], v[3];
    double push;  /* N·s, the ground's normal impulse in the last step */
    double level; /* the cosine of the ground's slope there */
};
/* One step as in Baraff–Witkin's: the new velocity moves the point, and the
 * ground's impulse is along its normal at the start, with friction by Coulomb's
 * law. The point ends `gap` over the smooth surface, or higher where the ground
 * need not push. False: nothing is near, or no impulse is found. */
bool point_step(const struct ground *g, struct point *p, double friction,
                double dt, double gap);

/* Finds places on the smooth surface from which a point slides with this
 * friction as validation.md §9 asks. Returns how many there are. `coarse`: the
 * same ground, smoothed half as far again. */
int find_paths(const struct ground *g, const struct ground *coarse,
               double friction, double start[PATHS][3]);

#endif
