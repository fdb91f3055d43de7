/* SPDX-License-Identifier: Apache-2.0 */
/* cuBLAS behind three functions, found at run time. */
#include "gpu/compare/blas.h"
#include "gpu/run/gpu.cuh"

#include <cublas_v2.h>
#include <dlfcn.h>

struct blas {
    struct gpu_library base; /* first: of this is g->library */
    void *library;
    cublasHandle_t handle;
    decltype(&cublasDestroy_v2) destroy;
    decltype(&cublasSdot_v2) sdot;
    decltype(&cublasDdot_v2) ddot;
    decltype(&cublasSaxpy_v2) saxpy;
    decltype(&cublasDaxpy_v2) daxpy;
    decltype(&cublasSscal_v2) sscal;
    decltype(&cublasDscal_v2) dscal;
};

/* The function of that name; *all becomes false where there is none. */
template <class F>
static void find(struct blas *b, const char *name, F *f, bool *all)
{
    void *found = dlsym(b->library, name);
    memcpy((void *)f, &found, sizeof found);
    *all = *all && found;
}

static bool load(struct blas *b, cudaStream_t stream)
{
    decltype(&cublasCreate_v2) create;
    decltype(&cublasSetStream_v2) set_stream;
    static const char *const names[] = {"libcublas.so.13", "libcublas.so.12",
                                        "libcublas.so"};
    for (int k = 0; k < 3 && !b->library; k++)
        b->library = dlopen(names[k], RTLD_NOW | RTLD_LOCAL);
    bool all = b->library != NULL;
    if (!all)
        return false;
    find(b, "cublasCreate_v2", &create, &all);
    find(b, "cublasSetStream_v2", &set_stream, &all);
    find(b, "cublasDestroy_v2", &b->destroy, &all);
    find(b, "cublasSdot_v2", &b->sdot, &all);
    find(b, "cublasDdot_v2", &b->ddot, &all);
    find(b, "cublasSaxpy_v2", &b->saxpy, &all);
    find(b, "cublasDaxpy_v2", &b->daxpy, &all);
    find(b, "cublasSscal_v2", &b->sscal, &all);
    find(b, "cublasDscal_v2", &b->dscal, &all);
    return all && create(&b->handle) == CUBLAS_STATUS_SUCCESS &&
           set_stream(b->handle, stream) == CUBLAS_STATUS_SUCCESS;
}

static void shut(struct gpu *g)
{
    struct blas *b = (struct blas *)g->library;
    if (b->handle)
        b->destroy(b->handle);
    if (b->library)
        dlclose(b->library);
    arena_give(&g->host, b);
    g->library = NULL;
}

int blas_open(struct gpu *g)
{
    if (g->library)
        return DRAPE_OK;
    struct blas *b =
        (struct blas *)arena_take(&g->host, ARENA_OTHER, 1, sizeof *b);
    if (!b)
        return DRAPE_ENOMEM;
    b->base.close = shut;
    g->library = &b->base;
    if (load(b, g->stream))
        return DRAPE_OK;
    shut(g);
    return DRAPE_EDEVICE;
}

/* Whether n can be said in cuBLAS's words and nothing failed before. */
static bool ready(struct gpu *g, int64_t n)
{
    if (!g->failed && (!g->library || n > INT32_MAX))
        g->failed = DRAPE_EDEVICE;
    return !g->failed;
}

static bool good(struct gpu *g, cublasStatus_t status)
{
    if (status != CUBLAS_STATUS_SUCCESS && !g->failed)
        g->failed = DRAPE_EDEVICE;
    return status == CUBLAS_STATUS_SUCCESS;
}

double blas_dot(struct gpu *g, int bits, int64_t n, const void *a,
                const void *b)
{
    struct blas *l = (struct blas *)g->library;
    float x = 0;
    double y = 0;
    if (!ready(g, n))
        return (double)NAN;
    cublasStatus_t status = bits == 32
                                ? l->sdot(l->handle, (int)n, (const float *)a,
                                          1, (const float *)b, 1, &x)
                                : l->ddot(l->handle, (int)n, (const double *)a,
                                          1, (const double *)b, 1, &y);
    return !good(g, status) ? (double)NAN : bits == 32 ? (double)x : y;
}

void blas_add(struct gpu *g, int bits, int64_t n, double scale, const void *a,
              void *b)
{
    struct blas *l = (struct blas *)g->library;
    float x = (float)scale;
    if (ready(g, n))
        good(g, bits == 32 ? l->saxpy(l->handle, (int)n, &x, (const float *)a,
                                      1, (float *)b, 1)
                           : l->daxpy(l->handle, (int)n, &scale,
                                      (const double *)a, 1, (double *)b, 1));
}

void blas_scale(struct gpu *g, int bits, int64_t n, double scale, void *a)
{
    struct blas *l = (struct blas *)g->library;
    float x = (float)scale;
    if (ready(g, n))
        good(g, bits == 32
                    ? l->sscal(l->handle, (int)n, &x, (float *)a, 1)
                    : l->dscal(l->handle, (int)n, &scale, (double *)a, 1));
}
