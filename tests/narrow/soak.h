/* SPDX-License-Identifier: Apache-2.0 */
/* What a soak of the narrow phase counts, a row of its table. */
#ifndef TESTS_SOAK_H
#define TESTS_SOAK_H

#include "tests/narrow/query.h"

struct soak {
    int64_t queries, touching;
    int64_t missed, invented; /* against GMP or the scene's truth */
    int64_t late, early;      /* of those found: another cell of 2^-30 */
    int64_t tier[3];          /* settled by */
    int64_t sampled, differ;  /* asked of CGAL, and other than GMP */
    double worst;             /* s, of a query */
};

/* The answer, counted and timed. */
uint32_t soak_decide(struct soak *s, const struct query *q);
void soak_add(struct soak *a, const struct soak *b);
bool soak_clean(const struct soak *s);
/* A query from the choices, against the oracles: what does not hold. */
const char *soak_query(struct bytes *b, int kind);
void soak_head(void);
void soak_print(const char *name, const struct soak *s);

#endif
