/* SPDX-License-Identifier: Apache-2.0 */
/* Whether two triangles intersect, exactly. spec/narrow/audit.md §3 */
#ifndef REF_TRITRI_H
#define REF_TRITRI_H

#include "ref/narrow/predicates.h"

/* A triangle of a mesh: its vertices, and where they are. */
struct face {
    int32_t v[3];
    point p[3]; /* m, |p| ≤ 2^60 */
};

/* Its plane, rounded, for filters: a corner, a normal, and the sum of the sizes
 * of the two products in each of the normal's components. */
struct plane {
    point o, n, size;
};

struct plane ref_plane(const struct face *t);

/* True where the three corners lie on one line. */
bool ref_collinear(const struct face *t);

/* True where t, of which of_t is the plane, and s have a common point beyond
 * what the vertices that they share make common; neither is collinear. */
bool ref_tritri(const struct face *t, const struct plane *of_t,
                const struct face *s);

#endif
