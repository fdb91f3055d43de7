/* SPDX-License-Identifier: Apache-2.0 */
/* The stream of the emulated device, in place of gpu/run/stream.cu: each call
 * is done at once. */
#include "gpu/run/batch.cuh"

#include <stdio.h>
#include <stdlib.h>
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

void gpu_up_now(struct gpu *g, void *device, const void *host, size_t bytes)
{
    gpu_copy_now(g, device, host, bytes);
}

void gpu_down_now(struct gpu *g, void *host, const void *device, size_t bytes)
{
    gpu_copy_now(g, host, device, bytes);
}

void gpu_copy_now(struct gpu *g, void *to, const void *from, size_t bytes)
{
    if (bytes && !fails(g, true))
        memcpy(to, from, bytes);
}

void gpu_clear_now(struct gpu *g, void *device, size_t bytes)
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

void gpu_wait_now(struct gpu *g)
{
    fails(g, false);
}

void *gpu_pin(struct gpu *g, size_t bytes)
{
    void *p = fails(g, true) ? NULL : malloc(bytes);
    if (!p && !g->failed)
        g->failed = DRAPE_ENOMEM;
    return p;
}

void gpu_unpin(struct gpu *g, void *p)
{
    (void)g;
    free(p);
}

void gpu_enter(struct gpu *g)
{
    (void)g;
}

/* The arguments of many worlds lie one after another, as on a device. */
void gpu_launch_now(struct gpu *g, const struct kernel_ways *k,
                    const struct launch_shape *s, const void *args, int worlds)
{
    for (int w = 0; w < worlds && !g->failed; w++) {
        const char *mine = (const char *)args;
        int64_t blocks = s->blocks;
        if (worlds > 1) {
            mine += (size_t)w * k->world_bytes;
            int64_t own =
                ((const struct world_head *)(const void *)mine)->blocks;
            blocks = own < blocks ? own : blocks;
            mine += sizeof(struct world_head);
        }
        emulate_call call(k->run, mine);
        if (s->kind == OF_ITEMS)
            emulate_items(s->items, s->rows, s->threads, call);
        else if (s->kind == OF_BLOCKS || s->kind == OF_PARTS)
            emulate_blocks(blocks, s->rows, s->threads, call);
        else
            emulate_cluster(s->bytes > g->room ? 0 : (int)s->blocks, s->rows,
                            s->threads, call);
    }
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
