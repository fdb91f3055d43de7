/* SPDX-License-Identifier: Apache-2.0 */
/* Wall time, for reports alone: no result depends on it. */
#ifndef REF_CLOCK_H
#define REF_CLOCK_H

#include <time.h>

static inline double clock_now(void) /* s */
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

#endif
