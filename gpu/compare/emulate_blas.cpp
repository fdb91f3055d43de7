/* SPDX-License-Identifier: Apache-2.0 */
/* What stands in for cuBLAS on the host: sums from front to back. */
#include "gpu/compare/blas.h"
#include "ref/base/stage.h"

int blas_open(struct gpu *g)
{
    (void)g;
    return DRAPE_OK;
}

template <class T> static T dot_of(int64_t n, const void *a, const void *b)
{
    T sum = 0;
    for (int64_t k = 0; k < n; k++)
        sum += ((const T *)a)[k] * ((const T *)b)[k];
    return sum;
}

double blas_dot(struct gpu *g, int bits, int64_t n, const void *a,
                const void *b)
{
    (void)g;
    return bits == 32 ? (double)dot_of<float>(n, a, b)
                      : dot_of<double>(n, a, b);
}

template <class T>
static void add_to(int64_t n, double scale, const void *a, void *b)
{
    for (int64_t k = 0; k < n; k++)
        ((T *)b)[k] += (T)scale * ((const T *)a)[k];
}

void blas_add(struct gpu *g, int bits, int64_t n, double scale, const void *a,
              void *b)
{
    (void)g;
    bits == 32 ? add_to<float>(n, scale, a, b) : add_to<double>(n, scale, a, b);
}

template <class T> static void scale_all(int64_t n, double scale, void *a)
{
    for (int64_t k = 0; k < n; k++)
        ((T *)a)[k] *= (T)scale;
}

void blas_scale(struct gpu *g, int bits, int64_t n, double scale, void *a)
{
    (void)g;
    bits == 32 ? scale_all<float>(n, scale, a) : scale_all<double>(n, scale, a);
}
