/* SPDX-License-Identifier: Apache-2.0 */
/* One case of a stage on the device, compared with the reference. */
#ifndef TESTS_DEVICE_H
#define TESTS_DEVICE_H

#include "gpu/run/gpu.h"
#include "tests/base/case.h"

/* Runs ref_X once and gpu_X several times, with different block sizes and
 * different poison in outputs and scratch, with loops ended by the host, and,
 * on an emulated device, with threads in other orders. Statuses and all outputs
 * must have the same bits; guards and inputs must be untouched. Does not set
 * hash. */
struct case_result device_case(const struct stage *stage, struct bytes *b,
                               struct gpu *g);
/* Whether one run of the case, with threads run in the given way, has other
 * results than the reference. */
bool device_differs(const struct stage *stage, struct bytes *b, struct gpu *g,
                    struct gpu_way way);
/* Returns the median time, s, of gpu_X on the benchmark's input. Sets *bytes to
 * the size of all streams. */
double device_bench(const struct stage *stage, struct gpu *g, int64_t *bytes);

#endif
