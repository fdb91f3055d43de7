/* SPDX-License-Identifier: Apache-2.0 */
/* Steps of many worlds: those of one device together, others by threads. */
#include "spec/drape.h"

#include <pthread.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "ref/api/handle.h"

enum { MOST_THREADS = 64 };

/* Worlds that are advanced in one way, by their places in the call's list. */
struct part {
    const struct call *call;
    int *of; /* [n] */
    int n, next;
    pthread_mutex_t lock;
};

/* The arguments of drape_step_many. */
struct call {
    drape_world *const *world;
    int n, steps, threads;
    drape_step_report *report;
    int *status;
};

/* Makes the steps of world k, up to one that fails or diverges. */
static void advance_world(const struct call *c, int k)
{
    drape_step_report *to =
        c->report ? c->report + (size_t)k * (size_t)c->steps : NULL;
    int status = DRAPE_OK, diverged = 0;
    for (int s = 0; s < c->steps && status == DRAPE_OK && !diverged; s++) {
        drape_step_report *report = to ? to + s : NULL;
        status = drape_step(c->world[k], report);
        diverged =
            report && status == DRAPE_OK && report->outcome & DRAPE_DIVERGED;
    }
    c->status[k] = status;
}

static void advance_in_part(void *with, int k)
{
    const struct part *p = with;
    advance_world(p->call, p->of[k]);
}

/* A thread takes the next world that nobody has taken until none is left. */
static void *advance_next_worlds(void *with)
{
    struct part *p = with;
    for (;;) {
        pthread_mutex_lock(&p->lock);
        int k = p->next++;
        pthread_mutex_unlock(&p->lock);
        if (k >= p->n)
            return NULL;
        advance_world(p->call, p->of[k]);
    }
}

/* Advances the worlds of a part by threads, of which this one is one. The
 * others block all signals: they are for the threads of the host program. */
static void advance_by_threads(struct part *p)
{
    pthread_t thread[MOST_THREADS];
    sigset_t all, before;
    int made = 0;
    pthread_mutex_init(&p->lock, NULL);
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    while (made < p->call->threads - 1 && made < p->n - 1 &&
           !pthread_create(&thread[made], NULL, advance_next_worlds, p))
        made++;
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    advance_next_worlds(p);
    for (int k = 0; k < made; k++)
        pthread_join(thread[k], NULL);
    pthread_mutex_destroy(&p->lock);
}

/* Advances the worlds of a part together; false if there is no memory. The logs
 * are written afterwards: they are the caller's, who need not expect another
 * stack. */
static bool advance_together(struct part *p)
{
    const struct call *c = p->call;
    const struct world_ops *ops = c->world[p->of[0]]->ops;
    struct world **world = malloc((size_t)p->n * sizeof *world);
    drape_log **log = calloc((size_t)p->n, sizeof *log);
    bool done = false;
    if (world && log) {
        for (int k = 0; k < p->n; k++) {
            drape_world *w = c->world[p->of[k]];
            world[k] = w->world;
            log[k] = w->log;
            w->log = NULL;
        }
        done = ops->together(world, p->n, c->threads, advance_in_part, p) ==
               DRAPE_OK;
        for (int k = 0; k < p->n; k++) {
            c->world[p->of[k]]->log = log[k];
            if (done)
                handle_tell_step(c->world[p->of[k]], c->status[p->of[k]]);
        }
    }
    free(world);
    free(log);
    return done;
}

/* The device on which a world can be advanced together with others, or -1. */
static int place_of(const drape_world *world)
{
    return world->ops->place && !world->record ? world->ops->place(world->world)
                                               : -1;
}

/* Advances the worlds that are advanced in the same way as world `first`, and
 * marks them as done. */
static void advance_like(struct part *p, int first, bool *done)
{
    const struct call *c = p->call;
    int place = place_of(c->world[first]);
    p->n = p->next = 0;
    for (int k = first; k < c->n; k++) {
        bool alike = place < 0 ? place_of(c->world[k]) < 0
                               : c->world[k]->ops == c->world[first]->ops &&
                                     place_of(c->world[k]) == place;
        if (done[k] || !alike)
            continue;
        p->of[p->n++] = k;
        done[k] = true;
    }
    if (place < 0 || p->n < 2 || !advance_together(p))
        advance_by_threads(p);
}

/* Whether a world is listed twice; marks are left as they were. */
static bool is_listed_twice(drape_world *const *world, int n)
{
    bool found = false;
    int k = 0;
    for (; k < n && !found; k++) {
        found = world[k]->listed;
        world[k]->listed = true;
    }
    while (k-- > 0)
        world[k]->listed = false;
    return found;
}

/* Whether the arguments are allowed. */
static bool are_arguments_valid(drape_world *const *world, int n, int steps,
                                int threads)
{
    if (n < 0 || steps < 0 || threads < 0 || (n && !world))
        return false;
    for (int k = 0; k < n; k++)
        if (!world[k])
            return false;
    return !is_listed_twice(world, n);
}

static int threads_of(int asked)
{
    long here = sysconf(_SC_NPROCESSORS_ONLN);
    int threads = asked ? asked : here < 1 ? 1 : (int)here;
    return threads < MOST_THREADS ? threads : MOST_THREADS;
}

int drape_step_many(drape_world *const *world, int n, int steps, int threads,
                    drape_step_report *report, int *status)
{
    if (!are_arguments_valid(world, n, steps, threads))
        return DRAPE_EARG;
    if (!n)
        return DRAPE_OK;
    int *own = malloc((size_t)n * 2 * sizeof *own), first = DRAPE_ENOMEM;
    bool *done = calloc((size_t)n, sizeof *done);
    if (own && done) {
        struct call c = {world,  n,
                         steps,  threads_of(threads),
                         report, status ? status : own + n};
        struct part p = {.call = &c, .of = own};
        if (report)
            memset(report, 0, (size_t)n * (size_t)steps * sizeof *report);
        for (int k = 0; k < n; k++)
            if (!done[k])
                advance_like(&p, k, done);
        first = DRAPE_OK;
        for (int k = 0; k < n && first == DRAPE_OK; k++)
            first = c.status[k];
    }
    free(own);
    free(done);
    return first;
}
