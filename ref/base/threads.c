/* SPDX-License-Identifier: Apache-2.0 */
/* The thread pool of parallel loops. The caller itself runs every part of a
 * loop that no worker has begun, so the caller never waits for a worker that
 * has no processor. No result depends on which thread runs a part:
 * spec/README.md §1.7. */
/* For sched_getaffinity, the processors that this thread may use. */
#define _GNU_SOURCE /* NOLINT(bugprone-reserved-identifier) */
#include "ref/base/threads.h"

#include "ref/base/stage.h"

#include <sched.h>
#include <signal.h>
#include <stddef.h>
#include <stdint.h>
#include <unistd.h>

/* Polls before a thread sleeps: some microseconds, about as long as waking a
 * thread takes. */
enum { POLLS = 4000 };

/* Of this thread: the pool that runs its loops; the part that it is running
 * now, number `number` of `count`. */
static _Thread_local struct threads *pool;
static _Thread_local int number, count = 1;
static _Thread_local int serial; /* depth of the enclosing loops that run in
                                    one part */

int threads_number(void)
{
    return serial ? 0 : number;
}

int threads_count(void)
{
    return serial ? 1 : count;
}

void threads_serial(int by)
{
    serial += by;
}

static int count_processors(void)
{
#ifdef CPU_COUNT
    cpu_set_t set;
    if (sched_getaffinity(0, sizeof set, &set) == 0 && CPU_COUNT(&set) > 0)
        return CPU_COUNT(&set);
#endif
    long n = sysconf(_SC_NPROCESSORS_ONLN);
    return n > 0 && n < THREADS_MOST ? (int)n : 1;
}

static void run_part(void run(void *data), void *data, int k, int n)
{
    struct threads *t = pool;
    int before = number, of = count, within = serial;
    pool = NULL; /* a loop inside a part is not divided */
    number = k;
    count = n;
    serial = 0;
    run(data);
    pool = t;
    number = before;
    count = of;
    serial = within;
}

static bool has_part(struct threads *t)
{
    return (uint32_t)atomic_load(&t->ticket) < (uint32_t)t->count;
}

/* Runs parts until all of the loop have begun. A ticket holds the number of its
 * loop, so an outdated ticket takes no part of a later loop. A loop ends only
 * after all of its parts, so a thread that has taken a part may read t->run and
 * t->data. */
static void run_parts(struct threads *t)
{
    unsigned long long ticket = atomic_load(&t->ticket);
    while ((uint32_t)ticket < (uint32_t)t->count) {
        if (!atomic_compare_exchange_weak(&t->ticket, &ticket, ticket + 1))
            continue;
        run_part(t->run, t->data, (int)(uint32_t)ticket, t->count);
        if (atomic_fetch_sub(&t->left, 1) == 1 && atomic_load(&t->waiting)) {
            pthread_mutex_lock(&t->lock);
            pthread_cond_signal(&t->done);
            pthread_mutex_unlock(&t->lock);
        }
        ticket = atomic_load(&t->ticket);
    }
}

/* Waits for a loop or the end. The worker announces its sleep in t->asleep and
 * then checks for work once more; threads_parallel publishes the loop and then
 * checks t->asleep. So no wake-up is lost. */
static void wait_for_work(struct threads *t)
{
    for (int k = 0; k < POLLS; k++)
        if (has_part(t) || atomic_load(&t->over))
            return;
    pthread_mutex_lock(&t->lock);
    atomic_fetch_add(&t->asleep, 1);
    while (!has_part(t) && !atomic_load(&t->over))
        pthread_cond_wait(&t->work, &t->lock);
    atomic_fetch_sub(&t->asleep, 1);
    pthread_mutex_unlock(&t->lock);
}

static void *run_worker(void *user)
{
    struct threads *t = user;
    /* waits until start_workers has set t->count */
    pthread_mutex_lock(&t->lock);
    pthread_mutex_unlock(&t->lock);
    while (!atomic_load(&t->over)) {
        run_parts(t);
        wait_for_work(t);
    }
    return NULL;
}

/* Starts t->asked threads, or as many of them as the system allows. Workers
 * block all signals: signals are for the threads of the host program. */
static void start_workers(struct threads *t)
{
    sigset_t all, before;
    pthread_mutex_init(&t->lock, NULL);
    pthread_cond_init(&t->work, NULL);
    pthread_cond_init(&t->done, NULL);
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    pthread_mutex_lock(&t->lock);
    int n = 1;
    while (n < t->asked && !pthread_create(&t->worker[n], NULL, run_worker, t))
        n++;
    t->count = n;
    atomic_store(&t->ticket, (unsigned)n); /* loop 0, all parts begun */
    pthread_mutex_unlock(&t->lock);
    pthread_sigmask(SIG_SETMASK, &before, NULL);
}

static void wait_for_parts(struct threads *t)
{
    for (int k = 0; k < POLLS; k++)
        if (atomic_load(&t->left) == 0)
            return;
    pthread_mutex_lock(&t->lock);
    atomic_store(&t->waiting, true);
    while (atomic_load(&t->left) > 0)
        pthread_cond_wait(&t->done, &t->lock);
    atomic_store(&t->waiting, false);
    pthread_mutex_unlock(&t->lock);
}

void threads_parallel(void run(void *data), void *data, unsigned most,
                      unsigned flags)
{
    struct threads *t = pool;
    (void)flags;
    if (t && most != 1 && t->asked > 1 && t->count == 0)
        start_workers(t);
    if (!t || most == 1 || t->count < 2) {
        run_part(run, data, 0, 1);
        return;
    }
    t->run = run;
    t->data = data;
    atomic_store(&t->left, t->count);
    atomic_store(&t->ticket, ((atomic_load(&t->ticket) >> 32) + 1) << 32);
    if (atomic_load(&t->asleep) > 0) {
        pthread_mutex_lock(&t->lock);
        pthread_cond_broadcast(&t->work);
        pthread_mutex_unlock(&t->lock);
    }
    run_parts(t);
    wait_for_parts(t);
}

/* The parts of threads_each. */
struct each {
    void (*part)(void *user, int k);
    void *user;
    int n;
    atomic_int next;
};

static void run_each(void *data)
{
    struct each *e = data;
    for (int k; (k = atomic_fetch_add(&e->next, 1)) < e->n;)
        e->part(e->user, k);
}

void threads_each(int n, bool spread, void part(void *user, int k), void *user)
{
    struct each e = {.part = part, .user = user, .n = n};
    if (spread)
        threads_parallel(run_each, &e, 0, 0);
    for (int k = 0; k < n && !spread; k++)
        part(user, k);
}

bool threads_spread(int64_t most, int64_t all)
{
    int n = pool ? pool->asked : 1;
    return n > 1 && most < all && (most <= STAGE_MANY || most * n <= all);
}

void threads_begin(struct threads *t, int threads)
{
    int most = THREADS_SOME, n = count_processors();
    if (most < 2 * n)
        most = 2 * n < THREADS_MOST ? 2 * n : THREADS_MOST;
    n = threads > 0 ? threads : n;
    t->outer = pool;
    t->asked = n < most ? n : most;
    t->count = 0;
    atomic_init(&t->ticket, 0);
    atomic_init(&t->left, 0);
    atomic_init(&t->asleep, 0);
    atomic_init(&t->waiting, false);
    atomic_init(&t->over, false);
    pool = t;
}

void threads_end(struct threads *t)
{
    pool = t->outer;
    if (t->count == 0)
        return;
    pthread_mutex_lock(&t->lock);
    atomic_store(&t->over, true);
    pthread_cond_broadcast(&t->work);
    pthread_mutex_unlock(&t->lock);
    for (int k = 1; k < t->count; k++)
        pthread_join(t->worker[k], NULL);
    pthread_cond_destroy(&t->work);
    pthread_cond_destroy(&t->done);
    pthread_mutex_destroy(&t->lock);
}
