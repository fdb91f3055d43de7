/* SPDX-License-Identifier: Apache-2.0 */
/* Hashes and times the stages of a run for the caller's function. */
#include "ref/base/trace.h"

#include "ref/base/clock.h"
#include "ref/base/hash.h"

void trace_stage(struct trace *t, const char *stage, const void *out,
                 size_t bytes)
{
    if (!t)
        return;
    double end = clock_now();
    t->call(t->user, t->step, stage, hash_mix(HASH_SEED, out, bytes),
            end - t->last);
    t->last = clock_now();
}
