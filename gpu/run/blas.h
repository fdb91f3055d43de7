/* SPDX-License-Identifier: Apache-2.0 */
/* For gpu/world/world.cu of branch `pipe`; goes with gpu/run/tape.cuh. */
#include "gpu/compare/blas.h"
