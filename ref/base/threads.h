/* SPDX-License-Identifier: Apache-2.0 */
/* The thread pool of parallel loops. The threads exist only during a call of
 * the API, and sleep while they have no work. spec/README.md §1.7 */
#ifndef REF_THREADS_H
#define REF_THREADS_H

#include <pthread.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>

/* The size of a pool is at most twice the number of processors, but at least
 * THREADS_SOME and never above THREADS_MOST: more threads would only take
 * memory. */
enum { THREADS_SOME = 8, THREADS_MOST = 1024 };

/* The pool of a thread that has called the API, between threads_begin and
 * threads_end. */
struct threads {
    struct threads *outer; /* the caller's previous pool, as calls may nest;
                              or NULL */
    int asked;             /* threads wanted, with the caller */
    int count;             /* threads there are, with the caller; 0: workers
                              not started yet */
    pthread_t worker[THREADS_MOST];

    /* The loop that is running, in `count` parts. */
    void (*run)(void *data);
    void *data;
    atomic_ullong ticket; /* the loop's number · 2^32 + parts begun */
    atomic_int left;      /* parts that have not ended */

    pthread_mutex_t lock; /* of the conditions, for threads that sleep */
    pthread_cond_t work, done;
    atomic_int asleep;   /* workers that sleep */
    atomic_bool waiting; /* the caller sleeps */
    atomic_bool over;
};

/* Until threads_end, loops of this thread run on up to `threads` threads; 0: as
 * many as there are processors for the thread. Fewer threads are used if the
 * system allows fewer. */
void threads_begin(struct threads *t, int threads);
void threads_end(struct threads *t);

/* Runs a parallel loop: calls run(data) once for each part. In the call,
 * threads_number is the part's number and threads_count the number of parts.
 * most = 1: one part only. The Makefile renames gcc's calls of its OpenMP
 * library to these functions; those of clang are in threads_clang.c. */
void threads_parallel(void run(void *data), void *data, unsigned most,
                      unsigned flags);
int threads_number(void);
int threads_count(void);
/* Calls part(user, k) once for each k below n. spread: side by side, each
 * within one thread, which takes the next k when it is free; else one after the
 * other, and all threads share the loops of each. */
void threads_each(int n, bool spread, void part(void *user, int k), void *user);
/* Whether parts that have `all` items together, the greatest `most` of them,
 * are done sooner side by side: none is more than a thread's share, or none has
 * loops that threads would share. */
bool threads_spread(int64_t most, int64_t all);
/* Called with 1 before and with -1 after a loop that runs in one part: between,
 * the part has number 0 of 1. */
void threads_serial(int by);

#endif
