/* SPDX-License-Identifier: Apache-2.0 */
/* Diagrams of single stages, one set a precision. */
#ifndef BENCH_STAGES_H
#define BENCH_STAGES_H

#include <stdio.h>

#include "ref/base/real.h"

#define stages_products REAL_NAME(stages_products)
#define stages_solves REAL_NAME(stages_solves)

/* Rows of products.csv: both forms of the matrix, seconds and bytes. Returns
 * how many products differ between the forms, which must be none. */
int stages_products(FILE *out, int quick);
/* Rows of solves.csv: iterations, reported and true residual. Returns how
 * often the true one missed the tolerance where the solver said it did not. */
int stages_solves(FILE *out, int quick);

#endif
