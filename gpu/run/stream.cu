/* SPDX-License-Identifier: Apache-2.0 */
/* Works on the stream of a device: copies, waits, failures, times and
 * readbacks. In a build without CUDA gpu/run/emulate_stream.cpp takes its
 * place. spec/gpu.md */
#include "gpu/run/batch.cuh"

#include <sched.h>
#include <stdio.h>

void gpu_note(struct gpu *g, cudaError_t error)
{
    if (error == cudaSuccess || g->failed)
        return;
    g->failed =
        error == cudaErrorMemoryAllocation ? DRAPE_ENOMEM : DRAPE_EDEVICE;
    size_t n = strlen(g->name);
    if (g->failed == DRAPE_EDEVICE)
        snprintf(g->name + n, sizeof g->name - n, ": %s",
                 cudaGetErrorString(error));
}

static void copy(struct gpu *g, void *to, const void *from, size_t bytes,
                 enum cudaMemcpyKind kind)
{
    if (bytes && !g->failed)
        gpu_note(g, cudaMemcpyAsync(to, from, bytes, kind, g->stream));
}

void gpu_up_now(struct gpu *g, void *device, const void *host, size_t bytes)
{
    copy(g, device, host, bytes, cudaMemcpyHostToDevice);
}

void gpu_down_now(struct gpu *g, void *host, const void *device, size_t bytes)
{
    copy(g, host, device, bytes, cudaMemcpyDeviceToHost);
    gpu_wait_now(g);
}

void gpu_copy_now(struct gpu *g, void *to, const void *from, size_t bytes)
{
    copy(g, to, from, bytes, cudaMemcpyDeviceToDevice);
}

void gpu_clear_now(struct gpu *g, void *device, size_t bytes)
{
    if (bytes && !g->failed)
        gpu_note(g, cudaMemsetAsync(device, 0, bytes, g->stream));
}

void gpu_wait_now(struct gpu *g)
{
    gpu_note(g, cudaStreamSynchronize(g->stream));
}

void *gpu_pin(struct gpu *g, size_t bytes)
{
    void *p = NULL;
    gpu_note(g, cudaMallocHost(&p, bytes));
    return p;
}

void gpu_unpin(struct gpu *g, void *p)
{
    if (p)
        gpu_note(g, cudaFreeHost(p));
}

void gpu_enter(struct gpu *g)
{
    gpu_note(g, cudaSetDevice(g->number));
}

int gpu_status(struct gpu *g)
{
    gpu_note(g, cudaPeekAtLastError());
    return g->failed;
}

void gpu_begin(struct gpu *g)
{
    cudaGetLastError(); /* an error of a lost device is reported again */
    if (g->failed == DRAPE_ENOMEM)
        g->failed = DRAPE_OK;
}

void gpu_clock_start(struct gpu *g)
{
    gpu_note(g, cudaEventRecord(g->event[0], g->stream));
}

double gpu_clock_stop(struct gpu *g)
{
    float ms = 0;
    gpu_note(g, cudaEventRecord(g->event[1], g->stream));
    gpu_note(g, cudaEventSynchronize(g->event[1]));
    gpu_note(g, cudaEventElapsedTime(&ms, g->event[0], g->event[1]));
    return 1e-3 * (double)ms;
}

/* Thread t owns word t and writes it to host memory. The mark, for which the
 * host waits, is written last. */
static __global__ void __launch_bounds__(GPU_ALL_WORDS)
    show_kernel(int64_t *words, bool clear, int64_t *seen, int64_t mark)
{
    seen[threadIdx.x] = words[threadIdx.x];
    if (clear)
        words[threadIdx.x] = 0;
    __threadfence_system();
    __syncthreads();
    if (threadIdx.x == 0)
        *(volatile int64_t *)&seen[GPU_ALL_WORDS] = mark;
}

static bool arrived(const int64_t *mark, int64_t next)
{
    return __atomic_load_n(mark, __ATOMIC_ACQUIRE) == next;
}

/* Waits until the mark is `next`. After a few looks the host lets other threads
 * run between two looks, as they may drive other worlds. Queries the state of
 * the stream every few milliseconds, as the kernel may have failed: more often,
 * and queries would keep other threads from launching, since both take a lock
 * of the driver. */
static void wait_for(struct gpu *g, const int64_t *mark, int64_t next)
{
    enum { LOOKS = 1 << 12, PATIENCE = 1 << 14 };
    for (int64_t k = 1; !arrived(mark, next); k++) {
        if (k > LOOKS)
            sched_yield();
        if (k % PATIENCE == 0 &&
            cudaStreamQuery(g->stream) != cudaErrorNotReady)
            break;
    }
    if (arrived(mark, next))
        return;
    gpu_wait_now(g);
    if (!arrived(mark, next)) /* the kernel did not run */
        gpu_note(g, cudaErrorUnknown);
}

/* A kernel writes the words to pinned host memory, and then a mark, which the
 * host polls. With a copy and a wait the host would know later. */
void gpu_read_back_now(struct gpu *g, bool clear)
{
    const int64_t *mark = g->seen + GPU_ALL_WORDS;
    int64_t next = *mark + 1;
    show_kernel<<<1, GPU_ALL_WORDS, 0, g->stream>>>(g->words, clear, g->seen,
                                                    next);
    wait_for(g, mark, next);
}
