/* SPDX-License-Identifier: Apache-2.0 */
/* Inverts the operator of the coarsest grid as a dense matrix.
 * spec/solve/multigrid.md §5 */
#include "gpu/solve/coarsest.cuh"

/* PITCH: the distance of two rows in shared memory, odd so that the rows begin
 * in different banks. */
enum { SIDE = 16, INVERT_BLOCK = SIDE * SIDE, PITCH = DENSE + 1 };

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

/* A thread's part of the sweep of unknown k. column: that of k, with the pivot;
 * next: gets that of k + 1. */
static __device__ void sweep(int n, double *a, int k, double inverse,
                             const double *column, double *next)
{
    OWN_ENTRIES(i, j, n)
    {
        double *e = a + i * PITCH + j, l = column[i] * inverse;
        if (inverse == 0) /* it is not swept */
            l = *e;
        else if (i == k)
            l = j == k ? -inverse : column[j] * inverse;
        else if (j != k)
            l = *e - l * column[j];
        *e = l;
        if (i == k + 1)
            next[j] = l;
        else if (j == k + 1)
            next[i] = l;
    }
}

/* Run by one block, which sweeps unknown after unknown. Each thread updates the
 * entries that it owns, and those of the next column twice. */
static __global__ void __launch_bounds__(INVERT_BLOCK)
    coarsest_invert_kernel(struct coarsest s)
{
    __shared__ double a[DENSE * PITCH], column[2][DENSE];
    __shared__ sym block[(STENCIL + 1) * COARSEST];
    __shared__ bool swept[DENSE];
    int n = 3 * (int)s.count, t = (int)threadIdx.x;
    int blocks = STENCIL * (int)s.count;
    double trace = 0;
    for (int e = t; e < blocks + (int)s.count; e += INVERT_BLOCK)
        block[e] = e < blocks ? s.block[e] : s.excess[e - blocks];
    __syncthreads();
    OWN_ENTRIES(i, j, n)
    {
        double e = a[i * PITCH + j] = entry(&s, block, i, j);
        if (j == 0)
            column[0][i] = e;
    }
    __syncthreads();
    for (int k = 0; k < n; k++)
        trace += a[k * PITCH + k];
    for (int k = 0; k < n; k++) {
        __syncthreads();
        const double *from = column[k % 2];
        bool good = from[k] > 0x1p-40 * trace;
        sweep(n, a, k, good ? 1 / from[k] : 0, from, column[(k + 1) % 2]);
        if (t == 0)
            swept[k] = good;
    }
    __syncthreads();
    OWN_ENTRIES(i, j, n)
    {
        double e = swept[i] && swept[j] ? -a[i * PITCH + j] : 0;
        s.dense[i * DENSE + j] = s.dense[j * DENSE + i] = e;
    }
}

void gpu_coarsest_invert(struct gpu *g, const struct coarsest *s)
{
    LAUNCH_BLOCKS(g, 1, INVERT_BLOCK, coarsest_invert_kernel, *s);
}
