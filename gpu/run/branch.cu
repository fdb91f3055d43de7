/* SPDX-License-Identifier: Apache-2.0 */
/* Branches of launches that may run beside each other, by streams that a graph
 * captures as well. gpu/run/launch.cuh */
#include "gpu/run/launch.cuh"

static void open(struct gpu *g, int k)
{
    if (!g->forked)
        gpu_note(g,
                 cudaEventCreateWithFlags(&g->forked, cudaEventDisableTiming));
    if (g->side[k])
        return;
    gpu_note(g, cudaStreamCreateWithFlags(&g->side[k], cudaStreamNonBlocking));
    gpu_note(g, cudaEventCreateWithFlags(&g->done[k], cudaEventDisableTiming));
}

void gpu_fork(struct gpu *g)
{
    if (g->together)
        return;
    open(g, 0);
    g->main = g->stream;
    if (!g->failed)
        gpu_note(g, cudaEventRecord(g->forked, g->main));
    g->used = 0;
}

void gpu_branch(struct gpu *g, int k)
{
    if (g->together)
        return;
    k %= GPU_SIDES;
    open(g, k);
    if (g->failed)
        return;
    g->stream = g->side[k];
    if (!(g->used >> k & 1))
        gpu_note(g, cudaStreamWaitEvent(g->stream, g->forked, 0));
    g->used |= 1u << k;
}

void gpu_join(struct gpu *g)
{
    if (g->together)
        return;
    g->stream = g->main;
    for (int k = 0; k < GPU_SIDES && !g->failed; k++) {
        if (!(g->used >> k & 1))
            continue;
        gpu_note(g, cudaEventRecord(g->done[k], g->side[k]));
        gpu_note(g, cudaStreamWaitEvent(g->stream, g->done[k], 0));
    }
}

void gpu_branches_close(struct gpu *g)
{
    for (int k = 0; k < GPU_SIDES; k++)
        if (g->side[k]) {
            cudaStreamDestroy(g->side[k]);
            cudaEventDestroy(g->done[k]);
        }
    if (g->forked)
        cudaEventDestroy(g->forked);
}
