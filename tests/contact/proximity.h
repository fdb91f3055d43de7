/* SPDX-License-Identifier: Apache-2.0 */
/* What the tests of stage proximity share. spec/contact/proximity.md */
#ifndef TESTS_PROXIMITY_H
#define TESTS_PROXIMITY_H

#include "ref/contact/proximity.h"
#include "ref/narrow/closest.h"
#include "tests/base/harness.h"

/* Two triangles around each vertex, as a rule with the other vertices of its
 * pairs [n][4]. */
struct one_rings pick_one_rings(struct bytes *b, int64_t nv, int64_t n,
                                const int32_t *pair);

/* The distance, m, of a vertex x[0] and a face, or of two edges, by other
 * methods than the stage's: regions of the plane, and clamping. */
double pair_distance(const struct wide x[4], int kind);

#endif
