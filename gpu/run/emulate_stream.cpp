/* SPDX-License-Identifier: Apache-2.0 */
/* The stream of the emulated device, in place of gpu/run/stream.cu: each call
 * is done at once. */
#include "gpu/run/launch.cuh"

#include <stdio.h>
#include <time.h>

/* Whether g has failed, so that nothing more may be done; records the failure.
 */
static bool fails(struct gpu *g, bool more)
{
    size_t n = strlen(g->name);
    if (!g->failed && emulate_lost(more)) {
        g->failed = DRAPE_EDEVICE;
        snprintf(g->name + n, sizeof g->name - n, ": lost on purpose");
    }
    return g->failed;
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

void gpu_fork(struct gpu *g)
{
    (void)g;
}

void gpu_branch(struct gpu *g, int k)
{
    (void)g;
    (void)k;
}

void gpu_join(struct gpu *g)
{
    (void)g;
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

void gpu_read_back_now(struct gpu *g, bool clear)
{
    size_t bytes = GPU_ALL_WORDS * sizeof *g->words;
    if (fails(g, true))
        return;
    memcpy(g->seen, g->words, bytes);
    if (clear)
        memset(g->words, 0, bytes);
}
