/* SPDX-License-Identifier: Apache-2.0 */
/* What the oracles answer; oracle/README.md says how far to trust which. */
#ifndef ORACLE_ORACLE_H
#define ORACLE_ORACLE_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* 1; 0 where the libraries were missing and no oracle but brute force was
 * built, so that all others answer -1. */
int orc_present(void);

/* Collision queries: the closed primitives move linearly from x0 to x1 over
 * t in [0, 1], both ends included. kind 0: vertex x[0] and face x[1..3];
 * kind 1: edges x[0]x[1] and x[2]x[3]. Every finite input has an answer. */
#define ORC_NEVER UINT32_MAX
/* *toi: floor(2^30 t) of the first touching t, or ORC_NEVER. Returns 1 where
 * they touch, 0 where not. Exact. */
int orc_ccd_gmp(int kind, const double x0[4][3], const double x1[4][3],
                uint32_t *toi);
int orc_ccd_cgal(int kind, const double x0[4][3], const double x1[4][3],
                 uint32_t *toi);
/* Baselines in floating point, never trusted: 1 or 0. `solver` 0: Newton, 1:
 * cubic roots, as FCL's Intersect calls them. *t: its time, or -1. */
int orc_ccd_fcl(int kind, int solver, const double x0[4][3],
                const double x1[4][3], double *t);
/* 1 where libccd says that the convex hulls of a[na] and b[nb] intersect:
 * method 0 GJK, 1 MPR. For a query: hulls of what the primitives sweep. */
int orc_hull_ccd(int method, int na, const double (*a)[3], int nb,
                 const double (*b)[3]);

/* Intersecting pairs of triangles of an indexed set, a < b ascending: the
 * first `cap` into pair. group: [nt] or NULL; pairs of two triangles of group
 * 0 are left out. *degenerate counts triangles on a line, which are in no
 * pair. Returns how many pairs there are. x: [nv][3], tri: [nt][3]. */
int64_t orc_self_pairs(int64_t nv, const double (*x)[3], int64_t nt,
                       const int32_t (*tri)[3], const int32_t *group,
                       int64_t cap, int32_t (*pair)[2], int64_t *degenerate);
/* The same by Polygon_mesh_processing::self_intersections; no groups; -1
 * where the triangles are no oriented manifold, which it needs. */
int64_t orc_self_pmp(int64_t nv, const double (*x)[3], int64_t nt,
                     const int32_t (*tri)[3], int64_t cap, int32_t (*pair)[2],
                     int64_t *degenerate);
/* Signs of determinants as ref/narrow/predicates.h defines them. */
int orc_orient3(const double a[3], const double b[3], const double c[3],
                const double d[3]);

/* Pairs of boxes with a common point, of one box of a (lo, hi: [n][3]) and
 * one of b, by all pairs; where a and b are the same arrays, i < j only.
 * The first `cap` into pair, ascending; returns how many there are. */
int64_t orc_box_pairs(int64_t na, const double (*alo)[3],
                      const double (*ahi)[3], int64_t nb,
                      const double (*blo)[3], const double (*bhi)[3],
                      int64_t cap, int32_t (*pair)[2]);

#ifdef __cplusplus
}
#endif
#endif
