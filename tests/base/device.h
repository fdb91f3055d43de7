/* SPDX-License-Identifier: Apache-2.0 */
/* A stage's case on the device, compared with the reference. */
#ifndef TESTS_DEVICE_H
#define TESTS_DEVICE_H

#include "gpu/run/gpu.h"
#include "tests/base/case.h"

/* Runs ref_X once and gpu_X twice, with other block sizes, other poison in
 * outputs and scratch, loops that the host ends and, emulated, the threads in
 * the opposite order: same status, same bits in every output, guards and inputs
 * untouched. hash is not set. */
struct case_result device_case(const struct stage *stage, struct bytes *b,
                               struct gpu *g);
/* Whether one run of the case differs, its threads being run in that way. */
bool device_differs(const struct stage *stage, struct bytes *b, struct gpu *g,
                    struct gpu_way way);
/* Median seconds of gpu_X on the benchmark's input; *bytes: its streams. */
double device_bench(const struct stage *stage, struct gpu *g, int64_t *bytes);

#endif
