/* SPDX-License-Identifier: Apache-2.0 */
/* What every stage shares: status codes (spec/drape.h), limits, and the
 * table of stages. spec/README.md §2. */
#ifndef REF_STAGE_H
#define REF_STAGE_H

#include "ref/base/real.h"
#include "spec/drape.h"

/* Threads take contiguous runs of items; no result depends on which. */
#define EACH_ITEM _Pragma("omp parallel for schedule(static)")
/* The same where there may be few of them: n light items. */
enum { STAGE_MANY = 4096 };
#define STAGE_PRAGMA(x) _Pragma(#x)
#define EACH_MANY(n)                                                           \
    STAGE_PRAGMA(omp parallel for schedule(static) if ((n) > STAGE_MANY))
/* The same, with a whole number that they add to. */
#define COUNT_MANY(n, sum)                                                     \
    STAGE_PRAGMA(omp parallel for reduction(+ : sum) if ((n) > STAGE_MANY))

#endif
