/* SPDX-License-Identifier: Apache-2.0 */
/* Shares a world's positions with a kernel of this program, on its own stream
 * and without a copy: the kernel finds the cloth's bounding box after each
 * step. Built by `make GPU=yes build/share`. Exits with 0 if every box equals
 * the box of drape_read's positions. */
#include <drape.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { SIDE = 101, STEPS = 60, BLOCK = 256 };

struct box {
    unsigned lo[3], hi[3]; /* floats mapped by rank_of */
};

/* Maps a float to an integer of the same order; real_of maps it back. */
static __device__ unsigned rank_of(float a)
{
    union {
        float real;
        unsigned bits;
    } u = {a};
    return u.bits & 0x80000000u ? ~u.bits : u.bits | 0x80000000u;
}

static float real_of(unsigned rank)
{
    union {
        unsigned bits;
        float real;
    } u = {rank & 0x80000000u ? rank & 0x7fffffffu : ~rank};
    return u.real;
}

/* Thread k owns vertex k: extends *box, which is empty before. */
static __global__ void __launch_bounds__(BLOCK)
    box_kernel(const float (*x)[3], int64_t n, struct box *box)
{
    int64_t k = (int64_t)blockIdx.x * BLOCK + threadIdx.x;
    for (int i = 0; k < n && i < 3; i++) {
        atomicMin(&box->lo[i], rank_of(x[k][i]));
        atomicMax(&box->hi[i], rank_of(x[k][i]));
    }
}

/* This program's own stream, box on the device, and box on the host. */
struct ours {
    cudaStream_t stream;
    struct box *there, here;
};

/* Runs the kernel after a step. It needs no synchronisation with the step, as
 * both are on the same stream. */
static bool measure(struct ours *o, drape_world *world)
{
    static const struct box empty = {{~0u, ~0u, ~0u}, {0, 0, 0}};
    drape_view view;
    if (drape_borrow(world, &view) != DRAPE_OK || view.device < 0)
        return false;
    cudaMemcpyAsync(o->there, &empty, sizeof empty, cudaMemcpyDefault,
                    o->stream);
    box_kernel<<<(unsigned)((view.vertices + BLOCK - 1) / BLOCK), BLOCK, 0,
                 o->stream>>>((const float(*)[3])view.x, view.vertices,
                              o->there);
    cudaMemcpyAsync(&o->here, o->there, sizeof o->here, cudaMemcpyDefault,
                    o->stream);
    return cudaStreamSynchronize(o->stream) == cudaSuccess;
}

/* Whether the box equals the box of a copy of the positions. */
static bool agrees(const struct box *box, drape_world *world)
{
    size_t n = (size_t)drape_vertices(world);
    double(*x)[3] = (double(*)[3])malloc(n * sizeof *x);
    bool same = x && drape_read(world, x, NULL) == DRAPE_OK;
    for (int i = 0; same && i < 3; i++) {
        double lo = INFINITY, hi = -INFINITY;
        for (size_t k = 0; k < n; k++) {
            lo = fmin(lo, x[k][i]);
            hi = fmax(hi, x[k][i]);
        }
        same = lo == (double)real_of(box->lo[i]) &&
               hi == (double)real_of(box->hi[i]);
    }
    free(x);
    return same;
}

static int run(struct ours *o, drape_world *world)
{
    int good = 0;
    for (int k = 0; k < STEPS; k++)
        good += drape_step(world, NULL) == DRAPE_OK && measure(o, world) &&
                agrees(&o->here, world);
    printf("%d of %d boxes agree, the last from %.3f to %.3f m in height\n",
           good, STEPS, (double)real_of(o->here.lo[1]),
           (double)real_of(o->here.hi[1]));
    return good == STEPS ? 0 : 1;
}

int main(void)
{
    const drape_pin pins[] = {{0, 0, -1}, {SIDE - 1, 0, -1}};
    struct ours o = {};
    drape_def def;
    drape_cloth cloth;
    drape_default(&def);
    drape_default_cloth(&cloth);
    cloth.m = cloth.n = SIDE;
    cloth.pins = pins;
    cloth.n_pins = 2;
    def.cloths = &cloth;
    def.n_cloths = 1;
    def.backend = DRAPE_GPU;
    if (cudaStreamCreate(&o.stream) != cudaSuccess ||
        cudaMalloc(&o.there, sizeof *o.there) != cudaSuccess) {
        fputs("there is no device here that can be used\n", stderr);
        return 1;
    }
    def.stream = o.stream;

    drape_world *world;
    drape_error error;
    int code = 1;
    if (drape_create(&def, &world, &error) == DRAPE_OK)
        code = run(&o, world);
    else
        fprintf(stderr, "%s\n", error.text);
    drape_destroy(world);
    cudaFree(o.there);
    cudaStreamDestroy(o.stream);
    return code;
}
