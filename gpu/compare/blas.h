/* SPDX-License-Identifier: Apache-2.0 */
/* Vector operations by cuBLAS, in an order of its own. The library is looked
 * for when blas_open is called; drape is not linked with it. C and C++.
 * spec/solve/pcg.md §6 */
#ifndef GPU_BLAS_H
#define GPU_BLAS_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

struct gpu;

/* Opens the library once, which gpu_close closes; DRAPE_OK, DRAPE_EDEVICE where
 * there is no library that can be used, DRAPE_ENOMEM. */
int blas_open(struct gpu *g);

/* On the device, n numbers of `bits`; failures are gpu_status's. */
double blas_dot(struct gpu *g, int bits, int64_t n, const void *a,
                const void *b); /* a·b; waits for it; NaN where it failed */
void blas_add(struct gpu *g, int bits, int64_t n, double scale, const void *a,
              void *b); /* b += scale·a */
void blas_scale(struct gpu *g, int bits, int64_t n, double scale, void *a);

#ifdef __cplusplus
}
#endif
#endif
