/* SPDX-License-Identifier: Apache-2.0 */
/* The table of the device's functions. ref/base/backend.h */
#ifndef GPU_BACKEND_H
#define GPU_BACKEND_H

#include "ref/base/backend.h"

#ifdef __cplusplus
extern "C" {
#endif

extern const struct backend backend_gpu;

#ifdef __cplusplus
}
#endif
#endif
