/* SPDX-License-Identifier: Apache-2.0 */
/* The ground that a sheet slides down: a mesh, and the smooth surface that a
 * sheet of some size feels of it. spec/validation.md §9 */
#ifndef VALIDATE_GROUND_H
#define VALIDATE_GROUND_H

#include "validate/validate.h"

/* A piece of a triangle. */
struct piece {
    double x[3];    /* its middle */
    double area[3]; /* m², along the normal */
};
struct ground {
    int64_t nv, nt;
    double (*x)[3];
    int32_t (*tri)[3];
    double radius;       /* m, within which pieces count */
    struct piece *piece; /* by the boxes of a grid whose side is radius */
    int64_t *first;      /* [boxes + 1] */
    double lo[3];
    int boxes[3];
};

/* Reads NAME.ply from the folders in which the tool looks for meshes, so large
 * that its largest extent is `size`. False: none of them has it, or it is no
 * such mesh as `drape convert` writes; then there is nothing to free. */
bool ground_statue(struct ground *g, const char *name, double size);
/* The flank of a boulder of 1 m radius with waves, in uneven triangles of about
 * this side, narrower towards the top, whose corners are moved out or in by up
 * to `rough` m. */
void ground_boulder(struct ground *g, double facet, double rough);
void ground_free(struct ground *g);

/* Prepares ground_height for a sheet of this side, once. */
void ground_smooth(struct ground *g, double side);
/* How high x is over the smooth surface, m, and the surface's normal there.
 * NAN: nothing is near. */
double ground_height(const struct ground *g, const double x[3],
                     double normal[3]);
/* Moves x along normals to this height; false if it does not get there. */
bool ground_put(const struct ground *g, double x[3], double height);

/* The triangles whose first vertex is within `reach` of a place, as an
 * obstacle, whose vertices and triangles the caller frees. */
void ground_near(const struct ground *g, const double at[3], double reach,
                 drape_obstacle *obstacle);
/* How far x is to be moved along n to be `gap` above the obstacle's triangles;
 * NAN: the line meets none within 20 mm. */
double ground_lift(const drape_obstacle *obstacle, const double x[3],
                   const double n[3], double gap);

double dot3(const double a[3], const double b[3]);
double apart3(const double a[3], const double b[3]);
void cross3(const double a[3], const double b[3], double out[3]);

#endif
