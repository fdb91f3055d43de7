/* SPDX-License-Identifier: Apache-2.0 */
/* What preconditions in ci/equal/twins.def are made of. They are executed
 * symbolically, as the functions are. */
#ifndef EQUAL_GIVEN_H
#define EQUAL_GIVEN_H

#include "ref/base/real.h"

/* Whether n numbers from a on are finite, or at most so large. */
static inline bool finite_doubles(const double *a, int n)
{
    bool good = true;
    for (int k = 0; k < n; k++)
        good = good & (fabs(a[k]) < INFINITY);
    return good;
}

static inline bool bounded_doubles(const double *a, int n, double most)
{
    bool good = true;
    for (int k = 0; k < n; k++)
        good = good & (fabs(a[k]) <= most);
    return good;
}

/* Whether n indices are of items 0 … most - 1. */
static inline bool indices_in(const int32_t *v, int n, int64_t most)
{
    bool good = true;
    for (int k = 0; k < n; k++)
        good = good & (v[k] >= 0) & (v[k] < most);
    return good;
}

/* Whether the row and the column of item k are within a grid of m by n items, as
 * they are where k < m n. */
static inline bool in_grid(int32_t m, int32_t n, int64_t k)
{
    int32_t j = (int32_t)k / m, i = (int32_t)k - j * m;
    return (m > 0) & (i >= 0) & (i < m) & (j >= 0) & (j < n);
}

/* Whether none of four vertices is led. */
static inline bool all_free(const real *w, const int32_t *v)
{
    bool good = true;
    for (int k = 0; k < 4; k++)
        good = good & (w[v[k]] > 0);
    return good;
}

#endif
