/* SPDX-License-Identifier: Apache-2.0 */
/* What preconditions in ci/equal/twins.def are made of. They are executed
 * symbolically, as the functions are. */
#ifndef EQUAL_GIVEN_H
#define EQUAL_GIVEN_H

#include "ref/base/real.h"

/* What kernels take that only the device has. */
struct opening {
    const sym *factor;
    vec *y;
    real damping;
};

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

static inline bool finite_reals(const real *a, int n)
{
    bool good = true;
    for (int k = 0; k < n; k++)
        good = good & (real_abs(a[k]) < R(INFINITY));
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

/* Whether the row and the column of item k are within a grid of m by n items,
 * as they are where k < m n. */
static inline bool in_grid(int32_t m, int32_t n, int64_t k)
{
    int32_t j = (int32_t)k / m, i = (int32_t)k - j * m;
    return (m > 0) & (i >= 0) & (i < m) & (j >= 0) & (j < n);
}

/* Whether an item's three coordinates are among those of n items. */
#define COORDINATES(k, n)                                                      \
    (((k) < (n)) & (3 * (k) < 3 * (n)) & (3 * (k) + 1 < 3 * (n)) &             \
     (3 * (k) + 2 < 3 * (n)))

/* Whether none of four vertices is led. */
static inline bool all_free(const real *w, const int32_t *v)
{
    bool good = true;
    for (int k = 0; k < 4; k++)
        good = good & (w[v[k]] > 0);
    return good;
}

/* Whether two triangles share no vertex. */
static inline bool share_none(const int32_t *f, const int32_t *g)
{
    bool good = true;
    for (int k = 0; k < 9; k++)
        good = good & (f[k / 3] != g[k % 3]);
    return good;
}

/* Whether the vertices of contact k keep the number of parts that they have:
 * ref/contact/contacts.c finds it before it pushes, the device when it does. */
#define PART_STANDS(s, i)                                                      \
    (((s)->parts[i] > 0) & ((s)->parts[i] >= (s)->acting[i]))
#define PARTS_STAND(s, k)                                                      \
    (!((s)->keep == 0) & PART_STANDS(s, (s)->contact[k].v[0]) &                \
     PART_STANDS(s, (s)->contact[k].v[1]) &                                    \
     PART_STANDS(s, (s)->contact[k].v[2]) &                                    \
     PART_STANDS(s, (s)->contact[k].v[3]))

/* The positions of four vertices at both ends of a step, as filter.c takes
 * them. */
static inline void widen_points(const vec *x, double y[2][4][3])
{
    for (int k = 0; k < 8; k++) {
        y[k / 4][k % 4][0] = (double)x[k].x;
        y[k / 4][k % 4][1] = (double)x[k].y;
        y[k / 4][k % 4][2] = (double)x[k].z;
    }
}

#endif
