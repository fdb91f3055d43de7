/* SPDX-License-Identifier: Apache-2.0 */
/* How many threads the caller's parallel regions take. */
#ifndef REF_THREADS_H
#define REF_THREADS_H

#ifdef _OPENMP
#include <omp.h>
#endif

/* Sets it, 0: as many as processors; returns what it was. */
static inline int threads_set(int threads)
{
#ifdef _OPENMP
    int before = omp_get_max_threads();
    omp_set_num_threads(threads > 0 ? threads : omp_get_num_procs());
    return before;
#else
    return threads;
#endif
}

#endif
