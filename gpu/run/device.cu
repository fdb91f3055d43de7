/* SPDX-License-Identifier: Apache-2.0 */
/* Opens and closes a device. spec/gpu.md */
#include "gpu/run/batch.cuh"
#include "gpu/run/loop.cuh"

extern "C" {
#include "ref/base/info.h"
}

#include "certificate.h"

#include <stdio.h>

/* Does nothing. Its attributes say for which devices the kernels were compiled.
 */
static __global__ void probe_kernel(void) {}

cudaError_t gpu_allow_cluster(struct gpu *g, const void *kernel, bool room)
{
    if (g->cluster_kernel == kernel)
        return cudaSuccess;
    cudaError_t error = cudaSuccess;
    if (room)
        error = cudaFuncSetAttribute(
            kernel, cudaFuncAttributeMaxDynamicSharedMemorySize, g->room);
    if (error == cudaSuccess && g->ranks > 1)
        error = cudaFuncSetAttribute(
            kernel, cudaFuncAttributeNonPortableClusterSizeAllowed, 1);
    g->cluster_kernel = error == cudaSuccess ? kernel : NULL;
    return error;
}

/* Whether a cluster of g->ranks blocks can run. */
static bool cluster_runs(struct gpu *g)
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
    cudaError_t error = gpu_allow_cluster(g, (const void *)probe_kernel, true);
    if (error == cudaSuccess)
        error = cudaOccupancyMaxActiveClusters(&teams, probe_kernel, &config);
    cudaGetLastError(); /* forget the error: it means that no cluster runs */
    return error == cudaSuccess && teams > 0;
}

/* Chooses the number of blocks of a cluster. Devices of compute capability 9
 * have clusters of at most 16 blocks and at least 8; a MIG instance may have
 * fewer. */
static void make_cluster(struct gpu *g, const cudaDeviceProp *p, int ptx)
{
    bool clusters = p->major >= 9 && ptx >= 90;
    g->multiprocessors = p->multiProcessorCount;
    g->room = (int)p->sharedMemPerBlockOptin;
    g->bulk = clusters;
    g->ranks = clusters ? 16 : 1;
    while (g->ranks > 1 && !cluster_runs(g))
        g->ranks /= 2;
}

static void name_device(struct gpu *g)
{
    cudaDeviceProp p;
    cudaFuncAttributes code;
    int driver = 0, runtime = 0;
    gpu_note(g, cudaGetDevice(&g->number));
    gpu_note(g, cudaGetDeviceProperties(&p, g->number));
    /* This fails if the kernels were not compiled for this device (ARCHES in
     * the Makefile). */
    gpu_note(g, cudaFuncGetAttributes(&code, probe_kernel));
    if (!g->failed)
        make_cluster(g, &p, code.ptxVersion);
    gpu_load_kernels(g);
    cudaDriverGetVersion(&driver);
    cudaRuntimeGetVersion(&runtime);
    snprintf(g->name, sizeof g->name, "%s, driver CUDA %d.%d, runtime %d.%d",
             g->failed ? "?" : p.name, driver / 1000, driver % 1000 / 10,
             runtime / 1000, runtime % 1000 / 10);
}

/* An error other than lack of memory stays CUDA's last error, for gpu_status.
 */
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
    g->multiprocessors =
        ranks < g->multiprocessors ? ranks : g->multiprocessors;
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
        cudaGetLastError(); /* the caller's next call must not see this error */
        return NULL;
    }
    struct gpu *g = gpu_make(def, gpu_native());
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
    gpu_batch_close(g);
    gpu_loops_close(g);
    cudaFreeHost(g->seen);
    cudaStream_t stream = g->lent ? NULL : g->stream;
    cudaEvent_t event[2] = {g->event[0], g->event[1]};
    gpu_branches_close(g);
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
