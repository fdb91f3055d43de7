/* SPDX-License-Identifier: Apache-2.0 */
/* Measurements of products and solves, once for each precision. */
#ifndef BENCH_STAGES_H
#define BENCH_STAGES_H

#include <stdio.h>

#include "ref/base/real.h"

#define stages_products REAL_NAME(stages_products)
#define stages_solves REAL_NAME(stages_solves)

/* Writes the rows of products.csv: seconds and bytes of both forms of the
 * matrix. Returns how many products differ between the forms, which must be
 * none. */
int stages_products(FILE *out, int quick);
/* Writes the rows of solves.csv: iterations, reported and true residual.
 * Returns how many solves reported convergence with a true residual above the
 * tolerance, which must be none. */
int stages_solves(FILE *out, int quick);

#endif
