/* SPDX-License-Identifier: Apache-2.0 */
/* The order of two CUDA streams: core.h. */
#include "python/core/core.h"

#ifdef DRAPE_CUDA
#include <cuda_runtime_api.h>

int core_stream_wait(void *stream, void *later)
{
    cudaEvent_t event;
    cudaError_t status =
        cudaEventCreateWithFlags(&event, cudaEventDisableTiming);
    if (status != cudaSuccess)
        return (int)status;
    status = cudaEventRecord(event, stream);
    if (status == cudaSuccess)
        status = cudaStreamWaitEvent(later, event, 0);
    cudaEventDestroy(event); /* once it has happened */
    return (int)status;
}
#else
int core_stream_wait(void *stream, void *later)
{
    (void)stream;
    (void)later;
    return -1;
}
#endif
