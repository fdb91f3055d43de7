/* SPDX-License-Identifier: Apache-2.0 */
/* The counters of a soak of the narrow phase: one row of its table. */
#ifndef TESTS_SOAK_H
#define TESTS_SOAK_H

#include "tests/narrow/query.h"

struct soak {
    int64_t queries, touching;
    int64_t missed, invented; /* contacts missed and invented, by GMP or the
                                 scene's truth */
    int64_t late, early;      /* contacts in a wrong cell of 2^-30 */
    int64_t tier[3];          /* queries decided by each tier */
    int64_t sampled, differ;  /* queries given to CGAL; CGAL differs from GMP */
    double worst;             /* s, longest time of a query */
};

/* Runs the narrow phase on a query, and counts and times it. */
uint32_t soak_decide(struct soak *s, const struct query *q);
void soak_add(struct soak *a, const struct soak *b);
bool soak_clean(const struct soak *s);
/* Compares a query made from the choices with the oracles. Returns NULL or the
 * property that fails. */
const char *soak_query(struct bytes *b, int kind);
void soak_head(void);
void soak_print(const char *name, const struct soak *s);

#endif
