/* SPDX-License-Identifier: Apache-2.0 */
/* One query of the narrow phase, for its tests. */
#ifndef TESTS_QUERY_H
#define TESTS_QUERY_H

#include "tests/choices.h"

struct query {
    int kind;
    vec x[2][4];
};

/* Coordinate i of 24: time, vertex, axis. */
real *query_at(struct query *q, int i);
/* What the narrow phase answers. */
uint32_t query_toi(const struct query *q);
void query_double(const struct query *q, double x[2][4][3]);
/* What does not hold of spec/30_narrow.md §7.2 where toi is the answer. */
const char *query_symmetry(const struct query *q, uint32_t toi);

#endif
