/* SPDX-License-Identifier: Apache-2.0 */
/* Closest points of two primitives: spec/contact/proximity.md §1 and §2. */
#ifndef REF_CLOSEST_H
#define REF_CLOSEST_H

#include "ref/base/wide.h"
#include "ref/broad/tree.h"

/* The closest points of sides A and B, relative to x[0]. */
struct closest {
    double c[4];    /* weights: side A adds to 1, side B to -1 */
    struct wide p;  /* Σ c x: from B's point to A's */
    double length2; /* p·p */
    double size2;   /* largest squared distance of x[1 … 3] from x[0] */
};

/* Closest points of vertex x[0] and the closed triangle x[1] x[2] x[3]. */
/*@ requires \forall integer k; 0 <= k < 4 ==>
  @     -0x1p60 <= x[k].x <= 0x1p60 && -0x1p60 <= x[k].y <= 0x1p60 &&
  @     -0x1p60 <= x[k].z <= 0x1p60; */
void closest_vf(const struct wide x[4], struct closest *r);
/* Closest points of the closed segments x[0] x[1] and x[2] x[3]. */
/*@ requires \forall integer k; 0 <= k < 4 ==>
  @     -0x1p60 <= x[k].x <= 0x1p60 && -0x1p60 <= x[k].y <= 0x1p60 &&
  @     -0x1p60 <= x[k].z <= 0x1p60; */
void closest_ee(const struct wide x[4], struct closest *r);
/* Rounds the weights to the build's precision, to multiples of a quantum, so
 * that the four add to 0 exactly; none gets the wrong sign. §2.3 */
/*@ requires 0 <= kind <= 1;
  @ requires \forall integer k; 0 <= k < 4 ==> -1 <= r->c[k] <= 1; */
void closest_weights(const struct closest *r, int kind, real c[4]);
/* The triangle's normal, or the cross product of the edges, not normalised. */
/*@ requires \forall integer k; 0 <= k < 4 ==>
  @     -0x1p60 <= x[k].x <= 0x1p60 && -0x1p60 <= x[k].y <= 0x1p60 &&
  @     -0x1p60 <= x[k].z <= 0x1p60;
  @ requires 0 <= kind <= 1; */
struct wide closest_normal(const struct wide x[4], int kind);
/* a times a power of two: where a is not zero its length is at least 2^-200, so
 * that no product of four such lengths underflows. §2.4 */
struct wide closest_lift(struct wide a);
/* a divided by its length, or the fallback where the length is zero or not
 * finite. */
struct wide closest_unit(struct wide a, struct wide fallback);

/* The surface around a closest point, proximity.md §3.2. */

/* Where the vertices of a surface are: at x0, or on the way to x1. */
struct places {
    const vec *x0, *x1; /* x1 NULL: they do not move */
    double t;           /* the part of the way */
};

/* The closest point of a side: in a face, on an edge or at a vertex, by how
 * many vertices have a weight. */
struct closest_point {
    int vertices;
    int32_t v[2];   /* the first two of them */
    struct wide at; /* m, relative to the first */
    struct wide p;  /* from here to the other side's point, lifted (§2.4) */
};

/* The closest point on the side whose vertices are v[from] … v[end - 1] of a
 * pair at x, with weights c; p: from here to the other side. */
struct closest_point closest_point_find(const int32_t v[4], int from, int end,
                                        const struct wide x[4],
                                        const double c[4], struct wide p);
/* The squared cosine from which on a surface comes nearer towards a vertex: of
 * a prescribed side, and of a free one. */
#define CLOSEST_PRESCRIBED 0x1p-28
#define CLOSEST_FREE 0x1p-20
/* Whether the closest point is the nearest point of the triangles around it. */
bool closest_point_is_local(const struct places *s,
                            const struct one_rings *one_rings,
                            const struct closest_point *f, double least);
/* The normal of the triangle at the closest point that p is most along, on p's
 * side. False if the squared cosine between them is not above `least` for any.
 */
bool closest_point_normal(const struct places *s,
                          const struct one_rings *one_rings,
                          const struct closest_point *f, double least,
                          struct wide *n);

/* Whether `face`, which has the closest point, is the first triangle there that
 * does not have the vertex `other`. */
bool closest_point_is_first(const struct one_rings *one_rings,
                            const struct closest_point *f,
                            const int32_t face[3], int32_t other);

#endif
