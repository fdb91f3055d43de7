/* SPDX-License-Identifier: Apache-2.0 */
/* Makes launches on the device; gpu/run/emulate_stream.cpp makes them on an
 * emulated one. gpu/run/kernel.cuh */
#include "gpu/run/batch.cuh"

static struct known_kernel *all_kernels;

bool gpu_know_kernel(struct known_kernel *k)
{
    k->next = all_kernels;
    all_kernels = k;
    return true;
}

void gpu_load_kernels(struct gpu *g)
{
    cudaFuncAttributes a;
    for (const struct known_kernel *k = all_kernels; k && !g->failed;
         k = k->next)
        gpu_note(g, cudaFuncGetAttributes(&a, k->one));
}

/* A cluster may need to be allowed for its kernel first. */
static cudaError_t allow(struct gpu *g, const void *kernel,
                         const struct launch_shape *s)
{
    return s->kind == OF_RANKS ? gpu_allow_cluster(g, kernel, s->bytes > 0)
                               : cudaSuccess;
}

void gpu_launch_now(struct gpu *g, const struct kernel_ways *k,
                    const struct launch_shape *s, const void *args, int worlds)
{
    const void *kernel = worlds > 1 ? k->many : k->one;
    const void *parameter = worlds > 1 ? &args : args;
    cudaLaunchAttribute attribute = {};
    cudaLaunchConfig_t config = {};
    config.gridDim = {(unsigned)s->blocks, (unsigned)s->rows, (unsigned)worlds};
    config.blockDim = {(unsigned)s->threads, 1, 1};
    config.dynamicSmemBytes = (size_t)s->bytes;
    config.stream = g->stream;
    config.attrs = &attribute;
    if (s->kind == OF_RANKS && s->blocks > 1) {
        attribute.id = cudaLaunchAttributeClusterDimension;
        attribute.val.clusterDim = {(unsigned)s->blocks, 1, 1};
        config.numAttrs = 1;
    } else if (s->kind == OF_GRID) {
        attribute.id = cudaLaunchAttributeCooperative;
        attribute.val.cooperative = 1;
        config.numAttrs = 1;
    }
    if (!g->failed)
        gpu_note(g, allow(g, kernel, s));
    if (!g->failed)
        gpu_note(g, cudaLaunchKernelExC(&config, kernel, (void **)&parameter));
}
