/* SPDX-License-Identifier: Apache-2.0 */
/* Queries of the narrow phase for tests: one vertex-face or edge-edge pair and
 * its motion. */
#ifndef TESTS_QUERY_H
#define TESTS_QUERY_H

#include "tests/base/choices.h"

struct query {
    int kind;
    vec x[2][4];
};

/* The families of the generator. Each makes motion that is degenerate in one
 * way. */
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

/* Picks a query of a family, of the given kind. */
struct query query_pick(struct bytes *b, int kind, int family);
/* Picks a query of ordinary size from a cloth, for the benchmark. */
struct query query_typical(struct bytes *b, int kind);
/* Returns a query of a real scene, of any kind. */
struct query query_real(uint32_t choice);
/* Replaces the queries of query_real by n queries, which the caller keeps; n =
 * 0 restores the built-in queries. */
void query_pool(const struct query *q, int n);

/* A public query, whether its primitives touch, and whether its coordinates are
 * exact in this precision, so that the known truth applies. */
struct known {
    struct query q;
    bool truth, exact;
};
/* Reads all public queries. The caller frees the result. Returns NULL with *n =
 * 0 where there are no files, with *n = -1 where a file cannot be read. */
struct known *query_load(int *n);

/* Returns coordinate i of 24, in the order time, vertex, axis. */
real *query_at(struct query *q, int i);
/* Run the narrow phase on a query. */
uint32_t query_toi(const struct query *q);
uint32_t query_tier(const struct query *q, int *tier);
void query_double(const struct query *q, double x[2][4][3]);
/* Checks spec/narrow/narrow.md §7.2 for the answer toi. Returns NULL or the
 * property that fails. */
const char *query_symmetry(const struct query *q, uint32_t toi);

#endif
