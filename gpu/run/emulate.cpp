/* SPDX-License-Identifier: Apache-2.0 */
/* Opens and closes a device that is emulated on the host. gpu/run/emulate.h */
#include "gpu/run/batch.cuh"

extern "C" {
#include "ref/base/info.h"
}

#include "certificate.h"

#include <stdio.h>
#include <stdlib.h>

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

struct gpu *gpu_open(const drape_def *def, int *status)
{
    struct gpu *g = gpu_make(def, gpu_native());
    *status = DRAPE_ENOMEM;
    if (!g)
        return NULL;
    snprintf(g->name, sizeof g->name, "emulated on the host");
    emulate_next_order();
    g->stream = def && def->stream ? def->stream : g;
    g->number = -1;
    g->bulk = true;
    g->ranks = EMULATE_RANKS;
    g->multiprocessors = 1;
    g->room = EMULATE_SHARED;
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
    gpu_batch_close(g);
    gpu_unmake(g);
}

const char *gpu_info(void)
{
    return WORLD_INFO("emulated on the host");
}
