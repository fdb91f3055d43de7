/* SPDX-License-Identifier: Apache-2.0 */
/* The threads that parallel loops run on. They are there within one call of the
 * API alone; one that waits sleeps. spec/README.md §1.7 */
#ifndef REF_THREADS_H
#define REF_THREADS_H

#include <pthread.h>
#include <stdatomic.h>
#include <stdbool.h>

/* More than some, and than twice the processors, and than most, are never
 * started, however many are asked for: they would only take memory. */
enum { THREADS_SOME = 8, THREADS_MOST = 1024 };

/* The team of a thread that called the API, between begin and end. */
struct threads {
    struct threads *outer; /* the caller's before, as calls may nest */
    int asked;             /* threads, the caller's own among them */
    int count;             /* that there are; 0: not looked for yet */
    pthread_t worker[THREADS_MOST];

    /* The loop under way, in `count` parts. */
    void (*run)(void *data);
    void *data;
    atomic_ullong ticket; /* the loop's number · 2^32 + parts begun */
    atomic_int left;      /* parts not ended */

    pthread_mutex_t lock; /* of those who sleep */
    pthread_cond_t work, done;
    atomic_int asleep;   /* workers */
    atomic_bool waiting; /* the caller */
    atomic_bool over;
};

/* Loops of this thread take up to `threads` threads, 0: as many as it may have
 * processors, until threads_end. Fewer where no more can be had. */
void threads_begin(struct threads *t, int threads);
void threads_end(struct threads *t);

/* What gcc calls for a loop: `run` once for each part, of which threads_number
 * says which it is and threads_count how many there are. `most` 1: in one part.
 * The Makefile gives its calls these names; clang's are in threads_clang.c. */
void threads_parallel(void run(void *data), void *data, unsigned most,
                      unsigned flags);
int threads_number(void);
int threads_count(void);
/* 1 before and -1 after what is a loop in one part of its own. */
void threads_serial(int by);

#endif
