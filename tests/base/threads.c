/* SPDX-License-Identifier: Apache-2.0 */
/* The thread pool of ref/base/threads.c: each part of a loop runs exactly once,
 * threads that wait sleep, and if the system allows fewer threads than asked
 * for, results have the same bits. */
#include "ref/base/threads.h"

#include <stdio.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "tests/world/scene.h"
#include "tests/world/slab.h"

enum { PARTS = 64, LOOPS = 3000 };

struct loop {
    int count[PARTS], of[PARTS];
    atomic_int inner, lone;
};

static void inner(void *user)
{
    struct loop *s = user;
    if (threads_count() == 1 && threads_number() == 0)
        atomic_fetch_add(&s->inner, 1);
}

static void part(void *user)
{
    struct loop *s = user;
    int k = threads_number(), n = threads_count();
    s->count[k]++;
    s->of[k] = n;
    threads_parallel(inner, s, 0, 0); /* a loop inside a part is not divided */

    /* The part is number 0 of 1 until a loop that runs in one part ends, also
     * after another loop in it. */
    threads_serial(1);
    threads_parallel(inner, s, 0, 0);
    bool lone = threads_number() == 0 && threads_count() == 1;
    threads_serial(-1);
    if (lone && threads_number() == k && threads_count() == n)
        atomic_fetch_add(&s->lone, 1);
}

/* Many short loops follow each other, so that workers may be late for some. */
const char *test_threads_parts(void)
{
    for (int n = 1; n <= THREADS_SOME; n += 3) {
        struct threads outer, t;
        struct loop s = {{0}, {0}, 0, 0};
        threads_begin(&outer, 2);
        threads_begin(&t, n);
        for (int k = 0; k < LOOPS; k++)
            threads_parallel(part, &s, 0, 0);
        threads_parallel(part, &s, 1, 0);
        threads_end(&t);
        threads_end(&outer);
        for (int k = 0; k < PARTS; k++)
            EXPECT(s.count[k] == (k < n ? LOOPS : 0) + (k == 0));
        for (int k = 1; k < n; k++)
            EXPECT(s.of[k] == n);
        EXPECT(s.of[0] == 1 && atomic_load(&s.inner) == 2 * (LOOPS * n + 1));
        EXPECT(atomic_load(&s.lone) == LOOPS * n + 1);
        ran(LOOPS);
    }
    return NULL;
}

/* How often the loop of each part ran, in how many parts of its own. */
struct each {
    atomic_int count[PARTS];
};

static void count_part(void *count)
{
    atomic_fetch_add((atomic_int *)count, 1);
}

static void run_one(void *user, int k)
{
    struct each *s = user;
    threads_parallel(count_part, &s->count[k], 0, 0);
}

/* Side by side each part runs once, within one thread; one after the other all
 * threads share its loops. */
const char *test_threads_each(void)
{
    for (int n = 1; n <= 4; n++)
        for (int spread = 0; spread < 2; spread++) {
            struct threads t;
            struct each s = {{0}};
            threads_begin(&t, n);
            for (int k = 0; k < LOOPS / 10; k++)
                threads_each(PARTS, spread, run_one, &s);
            threads_end(&t);
            int shared = spread ? 1 : n;
            for (int k = 0; k < PARTS; k++)
                EXPECT(atomic_load(&s.count[k]) == LOOPS / 10 * shared);
            ran(LOOPS / 10);
        }
    return NULL;
}

/* What is spread: nothing by one thread, nothing that is one part, and neither
 * a cloth that several threads could share. */
const char *test_threads_spread(void)
{
    struct threads t;
    EXPECT(!threads_spread(10, 100));
    threads_begin(&t, 4);
    bool right = threads_spread(10, 11) && !threads_spread(10, 10) &&
                 threads_spread(STAGE_MANY, STAGE_MANY + 1) &&
                 threads_spread(100000, 400000) &&
                 !threads_spread(100001, 400000) && !threads_spread(0, 0);
    threads_end(&t);
    EXPECT(right);
    ran(7);
    return NULL;
}

/* Waits ten seconds at most for *flag to become `want`; whether it did. */
static bool becomes(atomic_int *flag, int want)
{
    struct timespec brief = {0, 1000000};
    for (int k = 0; k < 10000 && atomic_load(flag) != want; k++)
        nanosleep(&brief, NULL);
    return atomic_load(flag) == want;
}

/* Two threads: `caller` and one worker. */
struct nap {
    struct threads t;
    pthread_t caller;
    atomic_int begun; /* the worker has begun its part */
    bool slept;       /* the caller slept while the worker ran */
};

/* The caller's part ends when the worker's has begun, and the worker's when the
 * caller sleeps. */
static void outlast(void *user)
{
    struct nap *s = user;
    struct timespec brief = {0, 1000000};
    if (pthread_equal(pthread_self(), s->caller)) {
        becomes(&s->begun, 1);
        return;
    }
    atomic_store(&s->begun, 1);
    for (int k = 0; k < 10000 && !atomic_load(&s->t.waiting); k++)
        nanosleep(&brief, NULL);
    s->slept = atomic_load(&s->t.waiting);
}

/* Between two loops all workers sleep, and the caller sleeps while a worker
 * still runs a part. */
const char *test_threads_sleep(void)
{
    for (int k = 0; k < 3; k++) {
        struct nap s = {.caller = pthread_self()};
        threads_begin(&s.t, 2);
        threads_parallel(outlast, &s, 0, 0);
        bool rests = becomes(&s.t.asleep, 1);
        threads_end(&s.t);
        EXPECT(s.slept && rests);
        ran(1);
    }
    return NULL;
}

/* Returns the hash of the state after two steps, 0 on any failure. */
static uint64_t run(int threads)
{
    struct slab d;
    uint64_t hash = 0;
    slab_make(&d, DRAPE_BW);
    d.cloth.m = d.cloth.n = 65;
    d.cloth.origin[1] = 0.1041;
    d.def.threads = threads;
    drape_world *world = slab_world(&d);
    if (world && drape_step(world, NULL) == DRAPE_OK &&
        drape_step(world, NULL) == DRAPE_OK)
        hash = scene_hash(world);
    drape_destroy(world);
    return hash;
}

/* The bytes of address space that this process has, and `more`: tests before
 * this one may have left it many. */
static rlim_t space_and(rlim_t more)
{
    unsigned long pages = 0;
    FILE *file = fopen("/proc/self/statm", "r");
    if (!file)
        return more;
    if (fscanf(file, "%lu", &pages) != 1)
        pages = 0;
    fclose(file);
    return (rlim_t)pages * (rlim_t)sysconf(_SC_PAGESIZE) + more;
}

/* The same in a child process that gets few threads, or no memory for their
 * stacks. The hash is 0, too, if the library ends the process. */
static uint64_t run_short(int resource, rlim_t most, int threads)
{
    int way[2], status;
    uint64_t hash = 0;
    if (pipe(way) != 0)
        return 0;
    pid_t child = fork();
    if (child == 0) {
        struct rlimit limit = {most, most};
        close(way[0]);
        if (setrlimit(resource, &limit) == 0)
            hash = run(threads);
        _exit(write(way[1], &hash, sizeof hash) != (ssize_t)sizeof hash);
    }
    close(way[1]);
    if (child < 0 || read(way[0], &hash, sizeof hash) != (ssize_t)sizeof hash)
        hash = 0;
    close(way[0]);
    if (child > 0 && (waitpid(child, &status, 0) != child || status != 0))
        hash = 0;
    return hash;
}

const char *test_threads_short(void)
{
    uint64_t want = run(1);
    EXPECT(want && run(0) == want && run(3) == want);
    EXPECT(run(4096) == want);
#ifdef __SANITIZE_ADDRESS__
    (void)run_short,
        (void)
            space_and; /* a sanitizer needs more memory than the limit leaves */
    ran(4);
#else
    EXPECT(run_short(RLIMIT_AS, space_and((rlim_t)1 << 30), 4096) == want);
    EXPECT(run_short(RLIMIT_NPROC, 1, 4096) == want); /* root has no limit */
    ran(6);
#endif
    return NULL;
}
