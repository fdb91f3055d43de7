/* SPDX-License-Identifier: Apache-2.0 */
/* One query of the narrow phase, for its tests. */
#ifndef TESTS_QUERY_H
#define TESTS_QUERY_H

#include "tests/base/choices.h"

struct query {
    int kind;
    vec x[2][4];
};

/* The families of the generator: motion that is degenerate in one way. */
enum query_family {
    QUERY_LATTICE,
    QUERY_PLANE,
    QUERY_OBLIQUE,
    QUERY_LINE,
    QUERY_TRANSLATION,
    QUERY_STILL,
    QUERY_COLLAPSED,
    QUERY_CONTACT,
    QUERY_END,
    QUERY_EDGE_ON,
    QUERY_GRAZING,
    QUERY_DOUBLE,
    QUERY_TRIPLE,
    QUERY_OFFSET,
    QUERY_SCALED,
    QUERY_NUDGED,
    QUERY_CLOTH,
    QUERY_SMOOTH,
    QUERY_REAL,
    QUERY_WILD,
    QUERY_FAMILIES
};

/* A query of a family; its kind is the one given. */
struct query query_pick(struct bytes *b, int kind, int family);
/* A cloth's query of ordinary size, for the benchmark. */
struct query query_typical(struct bytes *b, int kind);
/* A query of a real scene, of any kind. */
struct query query_real(uint32_t choice);
/* Replaces the queries that query_real has; the caller's, n = 0 to undo. */
void query_pool(const struct query *q, int n);

/* A query of ccd/queries, whether it touches, and whether its numbers
 * are numbers of this precision, so that the truth is. */
struct known {
    struct query q;
    bool truth, exact;
};
/* All of them, the caller's to free; NULL with *n = 0 where there are none,
 * with *n = -1 where a file cannot be read. */
struct known *query_load(int *n);

/* Coordinate i of 24: time, vertex, axis. */
real *query_at(struct query *q, int i);
/* What the narrow phase answers. */
uint32_t query_toi(const struct query *q);
uint32_t query_tier(const struct query *q, int *tier);
void query_double(const struct query *q, double x[2][4][3]);
/* What does not hold of spec/narrow/narrow.md §7.2 where toi is the answer. */
const char *query_symmetry(const struct query *q, uint32_t toi);

#endif
