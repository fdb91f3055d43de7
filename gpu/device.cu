/* SPDX-License-Identifier: Apache-2.0 */
/* The device: its stream, memory and small results. spec/50_gpu.md */
#include "gpu/blas.h"
#include "gpu/gpu.cuh"

#include "certificate.h"

#include <stdio.h>
#include <stdlib.h>

/* What was taken: a host record, found by its address on the device. */
struct gpu_block {
    struct gpu_block *next;
    void *data;
    size_t bytes;
    enum arena_part part;
};

void gpu_note(struct gpu *g, cudaError_t error)
{
    if (error == cudaSuccess || g->failed)
        return;
    g->failed =
        error == cudaErrorMemoryAllocation ? DRAPE_ENOMEM : DRAPE_EDEVICE;
}

/* Does nothing; how it was compiled holds for all kernels. */
static __global__ void probe_kernel(void) {}

static void name_device(struct gpu *g)
{
    cudaDeviceProp p;
    cudaFuncAttributes code;
    int driver = 0, runtime = 0;
    gpu_note(g, cudaGetDeviceProperties(&p, 0));
    /* fails where ARCHES left this device out */
    gpu_note(g, cudaFuncGetAttributes(&code, probe_kernel));
    g->teams = !g->failed && p.major >= 9 && code.ptxVersion >= 90;
    cudaDriverGetVersion(&driver);
    cudaRuntimeGetVersion(&runtime);
    snprintf(g->name, sizeof g->name, "%s, driver CUDA %d.%d, runtime %d.%d",
             g->failed ? "?" : p.name, driver / 1000, driver % 1000 / 10,
             runtime / 1000, runtime % 1000 / 10);
}

struct gpu *gpu_open(int *status)
{
    int devices = 0;
    *status = DRAPE_EDEVICE;
    if (cudaGetDeviceCount(&devices) != cudaSuccess || devices < 1)
        return NULL;
    struct gpu *g = (struct gpu *)calloc(1, sizeof *g);
    *status = DRAPE_ENOMEM;
    if (!g)
        return NULL;
    g->block = GPU_BLOCK;
    gpu_note(g, cudaSetDevice(0));
    gpu_note(g, cudaStreamCreate(&g->stream));
    for (int k = 0; k < 2; k++)
        gpu_note(g, cudaEventCreate(&g->event[k]));
    gpu_note(g, cudaMalloc(&g->words, GPU_WORDS * sizeof *g->words));
    gpu_note(g, cudaMallocHost(&g->seen, GPU_WORDS * sizeof *g->seen));
    name_device(g);
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
    while (g->blocks)
        gpu_give(g, g->blocks->data);
    blas_close(g);
    for (int k = 0; k < GPU_SLOTS; k++)
        cudaFree(g->slot[k].data);
    cudaFree(g->words);
    cudaFreeHost(g->seen);
    for (int k = 0; k < 2; k++)
        if (g->event[k])
            cudaEventDestroy(g->event[k]);
    if (g->stream)
        cudaStreamDestroy(g->stream);
    free(g);
}

const char *gpu_info(void)
{
    return WORLD_INFO("CUDA, binary32, binary64");
}

const char *gpu_name(const struct gpu *g)
{
    return g->name;
}

void gpu_set_block(struct gpu *g, int threads)
{
    g->block = threads;
}

void *gpu_take(struct gpu *g, enum arena_part part, int64_t count, size_t size)
{
    struct gpu_block *b = (struct gpu_block *)calloc(1, sizeof *b);
    size_t bytes = (size_t)count * size;
    if (!b) {
        gpu_note(g, cudaErrorMemoryAllocation);
        return NULL;
    }
    cudaError_t error = cudaMalloc(&b->data, bytes ? bytes : 1);
    gpu_note(g, error);
    if (error != cudaSuccess) {
        cudaGetLastError(); /* it is noted */
        free(b);
        return NULL;
    }
    b->bytes = bytes;
    b->part = part;
    b->next = g->blocks;
    g->blocks = b;
    g->bytes[part] += bytes;
    gpu_clear(g, b->data, bytes);
    return b->data;
}

void gpu_give(struct gpu *g, void *p)
{
    for (struct gpu_block **at = &g->blocks; p && *at; at = &(*at)->next)
        if ((*at)->data == p) {
            struct gpu_block *b = *at;
            *at = b->next;
            g->bytes[b->part] -= b->bytes;
            gpu_wait(g);
            cudaFree(p);
            free(b);
            return;
        }
}

const size_t *gpu_held(const struct gpu *g)
{
    return g->bytes;
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

int64_t *gpu_words(struct gpu *g)
{
    gpu_clear(g, g->words, GPU_WORDS * sizeof *g->words);
    return g->words;
}

const int64_t *gpu_read_words(struct gpu *g, int n)
{
    gpu_down(g, g->seen, g->words, (size_t)n * sizeof *g->seen);
    return g->seen;
}

void *gpu_scratch(struct gpu *g, int slot, int64_t count, size_t size)
{
    struct gpu_slot *s = &g->slot[slot];
    size_t bytes = (size_t)count * size + 1;
    if (bytes <= s->bytes)
        return s->data;
    gpu_wait(g);
    cudaFree(s->data);
    s->data = NULL;
    s->bytes = 0;
    bytes += bytes / 4; /* so that growth is rare */
    cudaError_t error = cudaMalloc(&s->data, bytes);
    gpu_note(g, error);
    if (error == cudaSuccess)
        s->bytes = bytes;
    else
        cudaGetLastError();
    return s->data;
}
