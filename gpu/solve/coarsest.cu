/* SPDX-License-Identifier: Apache-2.0 */
/* Factors the operator of the coarsest grid as a dense matrix.
 * spec/solve/multigrid.md §5 */
#include "gpu/solve/coarsest.cuh"

/* PITCH: the distance of two rows in shared memory, odd so that the rows begin
 * in different banks. */
enum { SIDE = 16, FACTOR_BLOCK = SIDE * SIDE, PITCH = DENSE + 1 };

static __device__ double component(sym b, int r, int c)
{
    int lo = r < c ? r : c, hi = r < c ? c : r;
    real a = lo == 2   ? b.zz
             : lo == 1 ? (hi == 1 ? b.yy : b.yz)
             : hi == 0 ? b.xx
             : hi == 1 ? b.xy
                       : b.xz;
    return (double)a;
}

/* Returns the index of the block that couples particles p < q, or -1 if none
 * does. The blocks of all directions are followed by the excess of all
 * particles. */
static __device__ int edge_of(const struct coarsest *s, struct place p,
                              struct place q)
{
    int di = q.i - p.i, dj = q.j - p.j, o = -1;
    if (dj == 0)
        o = di == 1 || di == 2 ? di - 1 : -1;
    else if (di >= -2 && di <= 2 && dj <= 2)
        o = di + (dj == 1 ? 4 : 9);
    return o < 0 ? -1 : o * (int)s->count + p.p;
}

/* Returns entry (r, c), c <= r, of the dense matrix. A diagonal entry adds its
 * blocks by ascending first particle. */
static __device__ double entry(const struct coarsest *s, const sym *block,
                               int r, int c)
{
    struct grid g = {s->m, s->n};
    struct place q = place_of(g, r / 3), p = {0, 0, 0};
    double sum = 0;
    r = r % 3;
    if (q.p != c / 3) {
        int edge = edge_of(s, place_of(g, c / 3), q);
        return edge < 0 ? sum : sum + -component(block[edge], r, c % 3);
    }
    c = c % 3;
    for (; p.p < q.p; p.p++) {
        int edge = edge_of(s, p, q);
        double b = component(block[edge < 0 ? 0 : edge], r, c);
        sum = edge < 0 ? sum : sum + b;
        p.i = p.i + 1 < g.m ? p.i + 1 : 0;
        p.j += p.i == 0;
    }
    sum += component(block[STENCIL * (int)s->count + q.p], r, c);
    for (int o = 0; o < STENCIL; o++) {
        double b = component(block[o * (int)s->count + q.p], r, c);
        bool good =
            within(g, q.i + toward_i<STENCIL>(o), q.j + toward_j<STENCIL>(o));
        sum = good ? sum + b : sum;
    }
    return sum;
}

/* A thread's loop over the entries that it owns: those in every SIDE-th row and
 * every SIDE-th column of the lower triangle. */
#define OWN_ENTRIES(i, j, n)                                                   \
    for (int i = (int)threadIdx.x / SIDE; i < (n); i += SIDE)                  \
        for (int j = (int)threadIdx.x % SIDE; j <= i; j += SIDE)

/* Run by one block. It eliminates column after column, and each thread updates
 * the entries that it owns. The columns of L are scaled at the end, since the
 * elimination reads unscaled columns. */
static __global__ void __launch_bounds__(FACTOR_BLOCK)
    coarsest_factor_kernel(struct coarsest s)
{
    __shared__ double a[DENSE * PITCH], inverse[DENSE];
    __shared__ sym block[(STENCIL + 1) * COARSEST];
    int n = 3 * (int)s.count, t = (int)threadIdx.x;
    int blocks = STENCIL * (int)s.count;
    double trace = 0;
    for (int e = t; e < blocks + (int)s.count; e += FACTOR_BLOCK)
        block[e] = e < blocks ? s.block[e] : s.excess[e - blocks];
    __syncthreads();
    OWN_ENTRIES(i, j, n)
    a[i * PITCH + j] = entry(&s, block, i, j);
    __syncthreads();
    for (int k = 0; k < n; k++)
        trace += a[k * PITCH + k];
    for (int k = 0; k < n; k++) {
        __syncthreads();
        double d = a[k * PITCH + k], scale = d > 0x1p-40 * trace ? 1 / d : 0;
        if (t == 0)
            inverse[k] = scale;
        OWN_ENTRIES(i, j, n)
        if (j > k)
            a[i * PITCH + j] -= (a[i * PITCH + k] * scale) * a[j * PITCH + k];
    }
    __syncthreads();
    OWN_ENTRIES(i, j, n)
    if (j < i)
        s.dense[i * DENSE + j] = a[i * PITCH + j] * inverse[j];
    if (t < n)
        s.dense[DENSE * DENSE + t] = inverse[t];
}

void gpu_coarsest_factor(struct gpu *g, const struct coarsest *s)
{
    LAUNCH_BLOCKS(g, 1, FACTOR_BLOCK, coarsest_factor_kernel, *s);
}
