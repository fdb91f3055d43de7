/* SPDX-License-Identifier: Apache-2.0 */
/* One case of one stage: generate, run twice with different poison, look. */
#ifndef TESTS_CASE_H
#define TESTS_CASE_H

#include "tests/base/choices.h"

/* Faults that the self-test plants after a run; each must be caught. */
enum fault {
    FAULT_NONE,
    FAULT_FLIP,     /* one bit of one output differs between the two runs */
    FAULT_MISS,     /* one output element is left as it was */
    FAULT_OVERRUN,  /* a byte behind an output is written */
    FAULT_UNDERRUN, /* a byte before an output is written */
    FAULT_INPUT,    /* an input is changed */
    FAULT_COUNT
};

struct case_result {
    const char *failed; /* NULL, or what does not hold */
    int status;         /* what ref_X returned */
    uint64_t hash;      /* of all outputs and the status */
    bool faulted;       /* there was something to plant the fault in */
};

/* prop: the stage's properties must hold too. */
struct case_result case_run(const struct stage *stage, struct bytes *b,
                            enum fault fault, bool prop);
/* Median seconds of ref_X on the benchmark's input; *bytes: its streams. */
double case_bench(const struct stage *stage, int64_t *bytes);

#endif
