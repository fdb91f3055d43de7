/* SPDX-License-Identifier: Apache-2.0 */
/* A point that slides on a ground, and where it does so for long enough.
 * spec/validation.md §9 */
#ifndef VALIDATE_PATH_H
#define VALIDATE_PATH_H

#include "validate/ground.h"

enum { PATHS = 3 };
static const double PATH_SECONDS = 0.25, PATH_GRAVITY = 9.81;

/* A point of mass 1 kg. */
struct point {
    double x[3], v[3];
    double push;  /* N·s, the ground's normal impulse in the last step */
    double level; /* the cosine of the ground's slope there */
};
/* What a point slides on. */
struct floor {
    /* How high x is over it, m, and its normal there; NAN: nothing is near. */
    double (*height)(const void *ground, const double x[3], double normal[3]);
    const void *ground;
    bool ends; /* its impulse is along its normal where the step ends, not where
                  it starts: as of edges, whose sides have normals of their own
                */
};
/* The smooth surface. */
struct floor floor_smooth(const struct ground *g);
/* The obstacle's own triangles. */
struct floor floor_facets(const drape_obstacle *obstacle);

/* One step as in Baraff–Witkin's: the new velocity moves the point, and the
 * floor's impulse is along its normal, with friction by Coulomb's law. The
 * point ends `gap` over the floor, or higher where the floor need not push.
 * False: nothing is near, or on a smooth surface no impulse is found. */
bool point_step(const struct floor *f, struct point *p, double friction,
                double dt, double gap);

/* Finds places on the smooth surface from which a point slides with this
 * friction as validation.md §9 asks. Returns how many there are. `coarse`: the
 * same ground, smoothed half as far again. */
int find_paths(const struct ground *g, const struct ground *coarse,
               double friction, double start[PATHS][3]);

#endif
