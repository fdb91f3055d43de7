/* SPDX-License-Identifier: Apache-2.0 */
/* Included by the files that run a world on the device: launches, and the
 * structs of every stage. Files of kernels include gpu/run/launch.cuh and what
 * they use. */
#ifndef GPU_GPU_CUH
#define GPU_GPU_CUH

#include "gpu/run/launch.cuh"

extern "C" {
#include "gpu/world/world.h"
#include "ref/base/keys.h"
#include "ref/base/stages.h"
#include "ref/world/checkpoint.h"
#include "ref/world/ending.h"
}

#endif
