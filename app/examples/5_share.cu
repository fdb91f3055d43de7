/* SPDX-License-Identifier: Apache-2.0 */
/* The same as 5_share.c on a GPU: a kernel of this program, on a stream of its
 * own, reads the positions where the world has them. Built by
 * `make GPU=yes build/5_share`. Exits with 0 if every step's lowest point is
 * that of drape_read's copy. */
#include <drape.h>
#include <stdio.h>

enum { SIDE = 101, STEPS = 60, BLOCK = 256 };

/* Maps a float to an integer of the same order, for atomicMin. */
static __host__ __device__ unsigned rank_of(float a)
{
    union {
        float real;
        unsigned bits;
    } u = {a};
    return u.bits & 0x80000000u ? ~u.bits : u.bits | 0x80000000u;
}

/* Thread k owns vertex k: lowers *lowest to the rank of its height. */
static __global__ void __launch_bounds__(BLOCK)
    lowest_kernel(const float (*x)[3], int64_t n, unsigned *lowest)
{
    int64_t k = (int64_t)blockIdx.x * BLOCK + threadIdx.x;
    if (k < n)
        atomicMin(lowest, rank_of(x[k][1]));
}

/* Whether the kernel finds what a copy has. Kernel and step need no
 * synchronisation with each other, as both are on the same stream. */
static bool agrees(drape_world *world, cudaStream_t stream, unsigned *there)
{
    static double x[SIDE * SIDE][3];
    unsigned here = 0, want = ~0u;
    drape_view view;
    if (drape_borrow(world, &view) != DRAPE_OK || view.device < 0)
        return false;
    cudaMemsetAsync(there, 0xff, sizeof *there, stream);
    lowest_kernel<<<(unsigned)((view.vertices + BLOCK - 1) / BLOCK), BLOCK, 0,
                    stream>>>((const float(*)[3])view.x, view.vertices, there);
    cudaMemcpyAsync(&here, there, sizeof here, cudaMemcpyDefault, stream);
    if (cudaStreamSynchronize(stream) != cudaSuccess ||
        drape_read(world, x, NULL) != DRAPE_OK)
        return false;
    for (int k = 0; k < SIDE * SIDE; k++)
        want = min(want, rank_of((float)x[k][1]));
    return here == want;
}

int main(void)
{
    const drape_pin pins[] = {{0, 0, -1}, {SIDE - 1, 0, -1}};
    cudaStream_t stream;
    unsigned *there; /* in the device's memory */
    drape_def def;
    drape_cloth cloth;
    drape_default(&def);
    drape_default_cloth(&cloth);
    cloth.pins = pins;
    cloth.n_pins = 2;
    def.cloths = &cloth;
    def.n_cloths = 1;
    def.backend = DRAPE_GPU;
    if (cudaStreamCreate(&stream) != cudaSuccess ||
        cudaMalloc(&there, sizeof *there) != cudaSuccess) {
        fputs("there is no device here that can be used\n", stderr);
        return 1;
    }
    def.stream = stream; /* which must outlive the world */

    drape_world *world;
    drape_error error;
    int good = 0;
    if (drape_create(&def, &world, &error) != DRAPE_OK)
        fprintf(stderr, "%s\n", error.text);
    for (int k = 0; k < STEPS && world; k++)
        good +=
            drape_step(world, NULL) == DRAPE_OK && agrees(world, stream, there);
    printf("%d of %d lowest points agree\n", good, STEPS);
    drape_destroy(world);
    cudaFree(there);
    cudaStreamDestroy(stream);
    return good == STEPS ? 0 : 1;
}
