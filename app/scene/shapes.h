/* SPDX-License-Identifier: Apache-2.0 */
/* Obstacles and starts of cloths made in code without libm, so that they have
 * the same bits on every machine. */
#ifndef APP_SCENE_SHAPES_H
#define APP_SCENE_SHAPES_H

#include "app/read/mesh.h"

/* cos and sin of 2π·turns to the last few bits; |turns| ≤ 2^30. */
void circle(double turns, double *c, double *s);
double square_root(double a);

enum shape_kind {
    SHAPE_PLANE,
    SHAPE_BOX,
    SHAPE_SPHERE,
    SHAPE_CAPSULE,
    SHAPE_LIMB,
    SHAPE_FUNNEL,
    SHAPE_STATUE,
    SHAPE_NONE
};
struct shape {
    int kind;
    double extent[3]; /* m; plane: x and z, box: x, y, z */
    double radius;    /* m; sphere, capsule, limb, the funnel's rim */
    double length;    /* m; capsule and limb between their centres, the funnel's
                         spout */
    double throat;    /* m; radius of the funnel's spout */
    double height;    /* m; the funnel's cone, the statue */
    int detail;       /* segments around, ≥ 8 */
};
/* Makes a mesh centred at the origin, closed except for plane and funnel; the
 * statue and the funnel's cone stand on y = 0. APP_OK, or APP_FAILED after one
 * line. */
int shape_make(struct pool *pool, const struct shape *shape, struct mesh *mesh);

/* A cloth's start that is not flat: each row i is a curve across v. */
struct start {
    int shape; /* START_… */
    double at[3], u[3], v[3];
    double folds, depth; /* hung: number of folds, their amplitude m */
    double radius, gap;  /* rolled: innermost radius, between layers, m */
};
enum { START_FLAT, START_HUNG, START_ROLLED };
/* Computes the points (a, b), in the plane of u and u × v, of m particles along
 * the curve, so that neighbours are h apart. False if the folds do not fit. */
bool start_curve(const struct start *start, int m, double h,
                 double (*curve)[2]);

#endif
