/* SPDX-License-Identifier: Apache-2.0 */
/* The coarsest grid by a dense factorisation. spec/14_multigrid.md §5 */
#include "gpu/coarsest.cuh"

/* PITCH: of a row in shared memory, odd for the banks. */
enum { FACTOR_BLOCK = 256, PITCH = DENSE + 1 };

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

/* The direction from particle p to q, -1 if none leads there. */
static __device__ int direction(int32_t m, int p, int q)
{
    int di = q % m - p % m, dj = q / m - p / m;
    if (dj == 0)
        return di == 1 || di == 2 ? di - 1 : -1;
    bool near = di >= -2 && di <= 2;
    return near && dj == 1 ? di + 4 : near && dj == 2 ? di + 9 : -1;
}

/* Entry (r, c) of the dense matrix, its terms by ascending first particle. */
static __device__ double entry(const struct coarsest *s, int r, int c)
{
    int p = r / 3, q = c / 3, count = (int)s->count;
    double sum = 0;
    if (p != q) {
        int o = direction(s->m, p < q ? p : q, p < q ? q : p);
        sym none = {0, 0, 0, 0, 0, 0};
        sym b = o < 0 ? none : s->block[o * count + (p < q ? p : q)];
        return o < 0 ? sum : sum + -component(b, r % 3, c % 3);
    }
    for (int k = 0; k < p; k++) {
        int o = direction(s->m, k, p);
        if (o >= 0)
            sum += component(s->block[o * count + k], r % 3, c % 3);
    }
    sum += component(s->excess[p], r % 3, c % 3);
    struct grid g = {s->m, s->n};
    for (int o = 0; o < STENCIL; o++)
        if (within(g, p % s->m + toward_i<STENCIL>(o),
                   p / s->m + toward_j<STENCIL>(o)))
            sum += component(s->block[o * count + p], r % 3, c % 3);
    return sum;
}

/* One block. Column after column; of a column its threads own the entries
 * that it changes. L is scaled at the end: no step reads a scaled column. */
static __global__ void __launch_bounds__(FACTOR_BLOCK)
    coarsest_factor_kernel(struct coarsest s)
{
    __shared__ double a[DENSE * (DENSE + 1)];
    __shared__ double inverse[DENSE];
    int n = 3 * (int)s.count, t = (int)threadIdx.x;
    double trace = 0;
    for (int e = t; e < n * n; e += FACTOR_BLOCK)
        a[e / n * PITCH + e % n] = entry(&s, e / n, e % n);
    __syncthreads();
    for (int k = 0; k < n; k++)
        trace += a[k * PITCH + k];
    for (int k = 0; k < n; k++) {
        __syncthreads();
        double d = a[k * PITCH + k], scale = d > 0x1p-40 * trace ? 1 / d : 0;
        int left = n - k - 1;
        if (t == 0)
            inverse[k] = scale;
        for (int e = t; e < left * left; e += FACTOR_BLOCK) {
            int i = k + 1 + e / left, j = k + 1 + e % left;
            if (j <= i)
                a[i * PITCH + j] -=
                    (a[i * PITCH + k] * scale) * a[j * PITCH + k];
        }
    }
    __syncthreads();
    for (int e = t; e < n * n; e += FACTOR_BLOCK) {
        int i = e / n, k = e % n;
        if (k < i)
            s.dense[i * DENSE + k] = a[i * PITCH + k] * inverse[k];
    }
    if (t < n)
        s.dense[DENSE * DENSE + t] = inverse[t];
}

void gpu_coarsest_factor(struct gpu *g, const struct coarsest *s)
{
    LAUNCH_BLOCKS(g, 1, FACTOR_BLOCK, coarsest_factor_kernel, *s);
}
