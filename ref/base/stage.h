/* SPDX-License-Identifier: Apache-2.0 */
/* What every stage includes: the number type, status codes (spec/drape.h), and
 * the pragmas of parallel loops. spec/README.md §1.7 and §2 */
#ifndef REF_STAGE_H
#define REF_STAGE_H

#include "ref/base/real.h"
#include "spec/drape.h"

/* A parallel loop over items. Each thread takes a contiguous run of items; no
 * result depends on how many threads there are. */
#define EACH_ITEM _Pragma("omp parallel for schedule(static)")
/* The same for n cheap items; up to STAGE_MANY of them run in one thread. */
enum { STAGE_MANY = 4096 };
#define STAGE_PRAGMA(x) _Pragma(#x)
#define EACH_MANY(n)                                                           \
    STAGE_PRAGMA(omp parallel for schedule(static) if ((n) > STAGE_MANY))
/* The same, for iterations that add to the integer `sum`. */
#define COUNT_MANY(n, sum)                                                     \
    STAGE_PRAGMA(omp parallel for reduction(+ : sum) if ((n) > STAGE_MANY))

#endif
