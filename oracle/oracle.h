/* SPDX-License-Identifier: Apache-2.0 */
/* The interface of the oracles. oracle/README.md says how far each can be
 * trusted. */
#ifndef ORACLE_ORACLE_H
#define ORACLE_ORACLE_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Returns 1, or 0 where the libraries are missing. Then only brute force is
 * built and all other oracles return -1. */
int orc_present(void);
/* Why a test is skipped that needs them. */
#define NO_ORACLES                                                             \
    "the oracles' libraries are not installed (sh ci/deps.sh installs them)"

/* Collision queries: the closed primitives move linearly from x0 to x1 over
 * t in [0, 1], both ends included. kind 0: vertex x[0] and face x[1..3];
 * kind 1: edges x[0]x[1] and x[2]x[3]. Every finite input has an answer. */
#define ORC_NEVER UINT32_MAX
/* Exact. Writes *toi = floor(2^30 t) of the first touching t, or ORC_NEVER.
 * Returns 1 where the primitives touch, 0 where not. */
int orc_ccd_gmp(int kind, const double x0[4][3], const double x1[4][3],
                uint32_t *toi);
int orc_ccd_cgal(int kind, const double x0[4][3], const double x1[4][3],
                 uint32_t *toi);
/* Floating-point baselines for comparison, which are never trusted. They call
 * FCL's Intersect with `solver` 0 (Newton) or 1 (cubic roots). Returns 1 or 0;
 * *t is the time found, or -1. */
int orc_ccd_fcl(int kind, int solver, const double x0[4][3],
                const double x1[4][3], double *t);
/* Returns 1 where libccd reports that the convex hulls of a[na] and b[nb]
 * intersect; method 0 is GJK, 1 is MPR. Queries pass the hulls of the swept
 * primitives. */
int orc_hull_ccd(int method, int na, const double (*a)[3], int nb,
                 const double (*b)[3]);

/* Finds the intersecting pairs of triangles of an indexed set, a < b,
 * ascending, and writes the first `cap` to pair. group is [nt] or NULL; pairs
 * of two triangles of group 0 are left out. *degenerate counts triangles whose
 * corners lie on one line; they are in no pair. Returns the number of pairs. x:
 * [nv][3], tri: [nt][3]. */
int64_t orc_self_pairs(int64_t nv, const double (*x)[3], int64_t nt,
                       const int32_t (*tri)[3], const int32_t *group,
                       int64_t cap, int32_t (*pair)[2], int64_t *degenerate);
/* As orc_self_pairs, by CGAL's Polygon_mesh_processing::self_intersections and
 * without groups. Returns -1 where the triangles are not an oriented manifold,
 * which that function requires. */
int64_t orc_self_pmp(int64_t nv, const double (*x)[3], int64_t nt,
                     const int32_t (*tri)[3], int64_t cap, int32_t (*pair)[2],
                     int64_t *degenerate);
/* Orientation predicates as ref/narrow/predicates.h defines them. */
int orc_orient3(const double a[3], const double b[3], const double c[3],
                const double d[3]);

/* Finds the pairs of one box of a (lo, hi: [n][3]) and one box of b that have a
 * common point, by comparing all pairs; where a and b are the same arrays, only
 * i < j. Writes the first `cap` to pair, ascending. Returns the number of
 * pairs. */
int64_t orc_box_pairs(int64_t na, const double (*alo)[3],
                      const double (*ahi)[3], int64_t nb,
                      const double (*blo)[3], const double (*bhi)[3],
                      int64_t cap, int32_t (*pair)[2]);

#ifdef __cplusplus
}
#endif
#endif
