/* SPDX-License-Identifier: Apache-2.0 */
/* The device: its stream, copies and small results. spec/gpu.md */
#include "gpu/run/loop.cuh"

#include "certificate.h"

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

/* Does nothing; how it was compiled holds for all kernels. */
static __global__ void probe_kernel(void) {}

cudaError_t gpu_allow_team(struct gpu *g, const void *kernel, bool room)
{
    if (g->team == kernel)
        return cudaSuccess;
    cudaError_t error = cudaSuccess;
    if (room)
        error = cudaFuncSetAttribute(
            kernel, cudaFuncAttributeMaxDynamicSharedMemorySize, g->room);
    if (error == cudaSuccess && g->ranks > 1)
        error = cudaFuncSetAttribute(
            kernel, cudaFuncAttributeNonPortableClusterSizeAllowed, 1);
    g->team = error == cudaSuccess ? kernel : NULL;
    return error;
}

/* Whether a team of g->ranks can run. */
static bool team_runs(struct gpu *g)
{
    cudaLaunchAttribute cluster = {};
    cluster.id = cudaLaunchAttributeClusterDimension;
    cluster.val.clusterDim = {(unsigned)g->ranks, 1, 1};
    cudaLaunchConfig_t config = {};
    config.gridDim = {(unsigned)g->ranks, 1, 1};
    config.blockDim = {GPU_BLOCK, 1, 1};
    config.dynamicSmemBytes = (size_t)g->room;
    config.attrs = &cluster;
    config.numAttrs = 1;
    int teams = 0;
    cudaError_t error = gpu_allow_team(g, (const void *)probe_kernel, true);
    if (error == cudaSuccess)
        error = cudaOccupancyMaxActiveClusters(&teams, probe_kernel, &config);
    cudaGetLastError(); /* an error of these is an answer */
    return error == cudaSuccess && teams > 0;
}

/* 16 blocks of a cluster are what a device of compute capability 9 has at
 * most, 8 what every one has; where a part of it is lent, perhaps none. */
static void make_team(struct gpu *g, const cudaDeviceProp *p, int ptx)
{
    bool clusters = p->major >= 9 && ptx >= 90;
    g->crowd = p->multiProcessorCount;
    g->room = (int)p->sharedMemPerBlockOptin;
    g->bulk = clusters;
    g->ranks = clusters ? 16 : 1;
    while (g->ranks > 1 && !team_runs(g))
        g->ranks /= 2;
}

static void name_device(struct gpu *g)
{
    cudaDeviceProp p;
    cudaFuncAttributes code;
    int driver = 0, runtime = 0;
    gpu_note(g, cudaGetDevice(&g->number));
    gpu_note(g, cudaGetDeviceProperties(&p, g->number));
    /* fails where ARCHES left this device out */
    gpu_note(g, cudaFuncGetAttributes(&code, probe_kernel));
    if (!g->failed)
        make_team(g, &p, code.ptxVersion);
    cudaDriverGetVersion(&driver);
    cudaRuntimeGetVersion(&runtime);
    snprintf(g->name, sizeof g->name, "%s, driver CUDA %d.%d, runtime %d.%d",
             g->failed ? "?" : p.name, driver / 1000, driver % 1000 / 10,
             runtime / 1000, runtime % 1000 / 10);
}

/* What fails for another reason than room stays CUDA's last error. */
static void *allocate(void *user, size_t bytes)
{
    void *p = NULL;
    (void)user;
    if (cudaMalloc(&p, bytes) == cudaErrorMemoryAllocation)
        cudaGetLastError();
    return p;
}

static void release(void *user, void *p, size_t bytes)
{
    (void)user;
    (void)bytes;
    cudaFree(p);
}

const drape_allocator *gpu_native(void)
{
    static const drape_allocator native = {allocate, release, NULL};
    return &native;
}

void gpu_set_ranks(struct gpu *g, int ranks)
{
    g->ranks = ranks < g->ranks ? ranks : g->ranks;
    g->crowd = ranks < g->crowd ? ranks : g->crowd;
}

void gpu_set_way(struct gpu *g, struct gpu_way way)
{
    g->hosted[0] = way.hosted;
    g->tight = way.tight;
}

struct gpu *gpu_open(const drape_def *def, int *status)
{
    int devices = 0;
    *status = DRAPE_EDEVICE;
    if (cudaGetDeviceCount(&devices) != cudaSuccess || devices < 1) {
        cudaGetLastError(); /* the caller's next call is not to see it */
        return NULL;
    }
    struct gpu *g = gpu_make(def);
    *status = DRAPE_ENOMEM;
    if (!g)
        return NULL;
    gpu_begin(g);
    name_device(g);
    g->lent = def && def->stream;
    if (g->lent)
        g->stream = (cudaStream_t)def->stream;
    else
        gpu_note(g, cudaStreamCreate(&g->stream));
    for (int k = 0; k < 2; k++)
        gpu_note(g, cudaEventCreate(&g->event[k]));
    gpu_note(g,
             cudaMallocHost(&g->seen, (GPU_ALL_WORDS + 1) * sizeof *g->seen));
    if (!g->failed)
        g->seen[GPU_ALL_WORDS] = 0;
    g->words =
        (int64_t *)gpu_take(g, ARENA_SCRATCH, GPU_ALL_WORDS, sizeof *g->words);
    *status = g->failed;
    if (g->failed) {
        gpu_close(g);
        return NULL;
    }
    return g;
}

void gpu_close(struct gpu *g)
{
    if (!g)
        return;
    gpu_wait(g);
    if (g->library)
        g->library->close(g);
    gpu_loops_close(g);
    cudaFreeHost(g->seen);
    cudaStream_t stream = g->lent ? NULL : g->stream;
    cudaEvent_t event[2] = {g->event[0], g->event[1]};
    gpu_unmake(g);
    for (int k = 0; k < 2; k++)
        if (event[k])
            cudaEventDestroy(event[k]);
    if (stream)
        cudaStreamDestroy(stream);
}

const char *gpu_info(void)
{
    return WORLD_INFO("CUDA, binary32, binary64");
}

static void copy(struct gpu *g, void *to, const void *from, size_t bytes,
                 enum cudaMemcpyKind kind)
{
    if (bytes && !g->failed)
        gpu_note(g, cudaMemcpyAsync(to, from, bytes, kind, g->stream));
}

void gpu_up(struct gpu *g, void *device, const void *host, size_t bytes)
{
    copy(g, device, host, bytes, cudaMemcpyHostToDevice);
}

void gpu_down(struct gpu *g, void *host, const void *device, size_t bytes)
{
    copy(g, host, device, bytes, cudaMemcpyDeviceToHost);
    gpu_wait(g);
}

void gpu_copy(struct gpu *g, void *to, const void *from, size_t bytes)
{
    copy(g, to, from, bytes, cudaMemcpyDeviceToDevice);
}

void gpu_clear(struct gpu *g, void *device, size_t bytes)
{
    if (bytes && !g->failed)
        gpu_note(g, cudaMemsetAsync(device, 0, bytes, g->stream));
}

void gpu_wait(struct gpu *g)
{
    gpu_note(g, cudaStreamSynchronize(g->stream));
}

int gpu_status(struct gpu *g)
{
    gpu_note(g, cudaPeekAtLastError());
    return g->failed;
}

void gpu_begin(struct gpu *g)
{
    cudaGetLastError(); /* what makes a device unusable comes again */
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

/* Thread t owns word t; the mark, which the host awaits, comes last. */
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

/* The stream is asked now and then, as it may have failed. */
static void await(struct gpu *g, const int64_t *mark, int64_t next)
{
    enum { PATIENCE = 1 << 12 };
    for (int64_t k = 1; !arrived(mark, next); k++)
        if (k % PATIENCE == 0 &&
            cudaStreamQuery(g->stream) != cudaErrorNotReady)
            break;
    if (arrived(mark, next))
        return;
    gpu_wait(g);
    if (!arrived(mark, next)) /* it was not launched */
        gpu_note(g, cudaErrorUnknown);
}

/* A kernel that writes to the host and a host that awaits it: that is sooner
 * than a copy is known to have ended. */
static void ask(struct gpu *g, bool clear)
{
    const int64_t *mark = g->seen + GPU_ALL_WORDS;
    int64_t next = *mark + 1;
    show_kernel<<<1, GPU_ALL_WORDS, 0, g->stream>>>(g->words, clear, g->seen,
                                                    next);
    await(g, mark, next);
}

static void show(struct gpu *g, bool clear)
{
    if (!g->failed)
        ask(g, clear);
    if (g->failed)
        memset(g->seen, 0, GPU_ALL_WORDS * sizeof *g->seen);
    gpu_keep_late(g, clear);
}

/* As many as are asked for would take as long. */
const int64_t *gpu_read_words(struct gpu *g, int)
{
    show(g, true);
    g->clean[0] = g->clean[1] = !g->failed;
    return g->seen;
}

const int64_t *gpu_look_words(struct gpu *g, int)
{
    show(g, false);
    return g->seen;
}
