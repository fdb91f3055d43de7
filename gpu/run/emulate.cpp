/* SPDX-License-Identifier: Apache-2.0 */
/* The device and its primitives on the host. */
#include "gpu/run/gpu.cuh"

#include "certificate.h"

#include <algorithm>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

/* ---- The device ---- */

static void *allocate(void *user, size_t bytes)
{
    (void)user;
    return emulate_lost(true) ? NULL
                              : aligned_alloc(64, (bytes + 63) / 64 * 64);
}

static void release(void *user, void *p, size_t bytes)
{
    (void)user;
    (void)bytes;
    free(p);
}

const drape_allocator *gpu_native(void)
{
    static const drape_allocator native = {allocate, release, NULL};
    return &native;
}

/* Whether g can do no more; notes why. */
static bool fails(struct gpu *g, bool more)
{
    size_t n = strlen(g->name);
    if (!g->failed && emulate_lost(more)) {
        g->failed = DRAPE_EDEVICE;
        snprintf(g->name + n, sizeof g->name - n, ": lost on purpose");
    }
    return g->failed;
}

struct gpu *gpu_open(const drape_def *def, int *status)
{
    struct gpu *g = gpu_make(def);
    *status = DRAPE_ENOMEM;
    if (!g)
        return NULL;
    snprintf(g->name, sizeof g->name, "emulated on the host");
    emulate_next_order();
    g->stream = def && def->stream ? def->stream : g;
    g->number = -1;
    g->bulk = true;
    g->ranks = EMULATE_RANKS;
    g->crowd = 1;
    g->room = EMULATE_ROOM;
    g->words =
        (int64_t *)gpu_take(g, ARENA_SCRATCH, GPU_ALL_WORDS, sizeof *g->words);
    g->seen = (int64_t *)arena_take(&g->host, ARENA_OTHER, GPU_ALL_WORDS,
                                    sizeof *g->seen);
    *status = g->seen ? g->failed : DRAPE_ENOMEM;
    if (*status == DRAPE_OK)
        return g;
    gpu_close(g);
    return NULL;
}

void gpu_set_ranks(struct gpu *g, int ranks)
{
    g->ranks = ranks < EMULATE_RANKS ? ranks : (int)EMULATE_RANKS;
}

void gpu_close(struct gpu *g)
{
    if (!g)
        return;
    gpu_unmake(g);
}

const char *gpu_info(void)
{
    return WORLD_INFO("emulated on the host");
}

void gpu_up(struct gpu *g, void *device, const void *host, size_t bytes)
{
    gpu_copy(g, device, host, bytes);
}

void gpu_down(struct gpu *g, void *host, const void *device, size_t bytes)
{
    gpu_copy(g, host, device, bytes);
}

void gpu_copy(struct gpu *g, void *to, const void *from, size_t bytes)
{
    if (bytes && !fails(g, true))
        memcpy(to, from, bytes);
}

void gpu_clear(struct gpu *g, void *device, size_t bytes)
{
    if (bytes && !fails(g, true))
        memset(device, 0, bytes);
}

void gpu_wait(struct gpu *g)
{
    fails(g, false);
}

int gpu_status(struct gpu *g)
{
    fails(g, false);
    return g->failed;
}

void gpu_begin(struct gpu *g)
{
    if (g->failed == DRAPE_ENOMEM)
        g->failed = DRAPE_OK;
}

static double host_clock(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

void gpu_clock_start(struct gpu *g)
{
    g->event = host_clock();
}

double gpu_clock_stop(struct gpu *g)
{
    return host_clock() - g->event;
}

static void show(struct gpu *g, bool clear)
{
    size_t bytes = GPU_ALL_WORDS * sizeof *g->words;
    if (!fails(g, true)) {
        memcpy(g->seen, g->words, bytes);
        if (clear)
            memset(g->words, 0, bytes);
    }
    if (g->failed)
        memset(g->seen, 0, bytes);
    gpu_keep_late(g, clear);
}

const int64_t *gpu_read_words(struct gpu *g, int n)
{
    (void)n;
    show(g, true);
    g->clean[0] = g->clean[1] = true;
    return g->seen;
}

const int64_t *gpu_look_words(struct gpu *g, int n)
{
    (void)n;
    show(g, false);
    return g->seen;
}

/* ---- Primitives ---- */

void gpu_scan(struct gpu *g, int64_t *a, int64_t n)
{
    int64_t sum = 0;
    if (g->failed || emulate_lost(true))
        return;
    for (int64_t k = 0; k < n; k++) {
        int64_t here = a[k];
        a[k] = sum;
        sum += here;
    }
}

struct key *gpu_sort(struct gpu *g, int64_t n, struct key *key,
                     struct key *spare)
{
    auto before = [](const struct key &a, const struct key &b) {
        if (a.hi != b.hi)
            return a.hi < b.hi;
        return a.lo != b.lo ? a.lo < b.lo : a.item < b.item;
    };
    (void)spare;
    if (!g->failed && !emulate_lost(true))
        std::sort(key, key + n, before);
    return key;
}
