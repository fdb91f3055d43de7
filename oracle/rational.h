/* SPDX-License-Identifier: Apache-2.0 */
/* Oracles in rational arithmetic for primitives that do not move.
 * oracle/README.md */
#ifndef ORACLE_RATIONAL_H
#define ORACLE_RATIONAL_H

#ifdef __cplusplus
extern "C" {
#endif

/* Returns 1 where two triangles with area have a common point besides their
 * first `shared` corners, which are the same in both, and the edge between
 * these: spec/narrow/audit.md §1. */
int orc_triangles(const double t[3][3], const double s[3][3], int shared);
/* Returns the sign of d - r, where d is the distance of a vertex x[0] from the
 * closed face x[1..3] (kind 0), or of the closed edges x[0]x[1] and x[2]x[3]
 * (kind 1). */
int orc_distance(int kind, const double x[4][3], double r);

#ifdef __cplusplus
}
#endif
#endif
