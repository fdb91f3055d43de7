/* SPDX-License-Identifier: Apache-2.0 */
/* One case of one stage: the input is generated, the stage runs twice with
 * different poison in its outputs, and the results are checked. */
#ifndef TESTS_CASE_H
#define TESTS_CASE_H

#include "tests/base/choices.h"

/* Faults that the self-test plants after a run; each must be caught. */
enum fault {
    FAULT_NONE,
    FAULT_FLIP,     /* one bit of one output differs between the two runs */
    FAULT_MISS,     /* one output element is not written */
    FAULT_OVERRUN,  /* a byte behind an output is written */
    FAULT_UNDERRUN, /* a byte before an output is written */
    FAULT_INPUT,    /* an input is changed */
    FAULT_COUNT
};

struct case_result {
    const char *failed; /* the condition that failed, or NULL */
    int status;         /* what ref_X returned */
    uint64_t hash;      /* of all outputs and the status */
    bool faulted;       /* the fault could be planted */
};

/* Runs one case. prop: also checks the stage's properties. */
struct case_result case_run(const struct stage *stage, struct bytes *b,
                            enum fault fault, bool prop);
/* Returns the median time, s, of ref_X on the benchmark's input. Sets *bytes to
 * the size of all streams. */
double case_bench(const struct stage *stage, int64_t *bytes);

#endif
