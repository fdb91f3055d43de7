/* SPDX-License-Identifier: Apache-2.0 */
/* Traces a run: calls the caller's function with a hash of each stage's output
 * and the time of the stage. A NULL trace is off and costs one comparison a
 * stage. */
#ifndef REF_TRACE_H
#define REF_TRACE_H

#include <stddef.h>
#include <stdint.h>

#include "ref/base/names.h"
#include "spec/drape.h"

struct trace {
    drape_trace *call;
    void *user;
    int64_t step;
    double last; /* s, the end of the stage before */
};

/* Called at the end of a stage, whose output is out[bytes]. */
void trace_stage(struct trace *t, const char *stage, const void *out,
                 size_t bytes);

#endif
