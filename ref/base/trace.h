/* SPDX-License-Identifier: Apache-2.0 */
/* The trace of a run: what each stage gave, and how long it took. Off (a NULL
 * pointer), it costs a comparison a stage. */
#ifndef REF_TRACE_H
#define REF_TRACE_H

#include "ref/base/clock.h"
#include "ref/base/hash.h"
#include "spec/drape.h"

struct trace {
    drape_trace *call;
    void *user;
    int64_t step;
    double last; /* s, when the stage before ended */
};

/* A stage has ended and given out[bytes]. */
static inline void trace_stage(struct trace *t, const char *stage,
                               const void *out, size_t bytes)
{
    if (!t)
        return;
    double end = clock_now();
    t->call(t->user, t->step, stage, hash_mix(HASH_SEED, out, bytes),
            end - t->last);
    t->last = clock_now();
}

#endif
