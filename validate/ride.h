/* SPDX-License-Identifier: Apache-2.0 */
/* A small sheet that slides down a flank, and points beside it.
 * spec/validation.md §9 */
#ifndef VALIDATE_RIDE_H
#define VALIDATE_RIDE_H

#include "validate/path.h"

enum { RIDE_SIDE = 11, RIDE_N = RIDE_SIDE * RIDE_SIDE };
#define RIDE_SIZE 0.04 /* m, of the sheet's side */

/* A sheet that slides from a place. */
struct ride {
    const struct ground *ground;
    const double *start;
    double friction, dt;
    int integrator, newton;
};

/* What came of it: the way over a point's, and over that of points on facets;
 * their way over that point's; how far aside; friction's work over what is due;
 * friction over load of a contact, over its coefficient, at most; what share of
 * gravity's work was lost; the speed at last. */
enum {
    RIDE_WAY,
    RIDE_FACETS,
    RIDE_GROUND,
    RIDE_ASIDE,
    RIDE_LAW,
    RIDE_CONE,
    RIDE_LOST,
    RIDE_CREEP,
    RIDE_RESULTS
};

/* Where the sheet's particles are after half a second with much friction, which
 * brings the sheet to rest. False: a step failed. */
bool ride_settle(const struct validate *v, const struct ride *slides,
                 double rest[RIDE_N][3]);

/* The mean way of points that start where particles of the sheet rest, each by
 * itself, on the mesh's own triangles, by short steps. Points that come to no
 * end are left out; NAN: more than a few do. */
void ride_points(const struct validate *v, const struct ride *r,
                 double rest[RIDE_N][3], double from[3], double to[3]);

/* Slides the sheet and the point side by side, from rest; NAN: it failed.
 * `way`: of points on facets, from and to. */
void ride_slide(const struct validate *v, const struct ride *r,
                double rest[RIDE_N][3], double way[2][3],
                double out[RIDE_RESULTS]);

#endif
