/* SPDX-License-Identifier: Apache-2.0 */
/* Inverts the operator of the coarsest grid as a dense matrix.
 * spec/solve/multigrid.md §5 */
#include "gpu/solve/coarsest.cuh"

#include "gpu/run/merge.cuh"

/* ENTRIES: of the lower triangle. OWN: the most of a thread. */
#ifdef __CUDACC__
enum { INVERT_BLOCK = 384 };
#else
enum { INVERT_BLOCK = 64 };
#endif
enum {
    ENTRIES = DENSE * (DENSE + 1) / 2,
    OWN = (ENTRIES + INVERT_BLOCK - 1) / INVERT_BLOCK
};

/* Row i and column j <= i of entry e of the lower triangle, row by row. */
static __device__ void place_entry(int e, int *i, int *j)
{
    int row = 0;
    while ((row + 1) * (row + 2) / 2 <= e)
        row++;
    *i = row;
    *j = e - row * (row + 1) / 2;
}

/* 1/d, or 0 if d is too small for a pivot: then its unknown is not swept. */
static __device__ double inverse_of(double d, double least)
{
    return d > least ? 1 / d : 0;
}

/* Entry (i, j), which is a, after unknown k is swept; li, lj: entries i and j
 * of column k before. Without branches, so that a thread's entries are swept at
 * once. */
static __device__ double swept(double a, int i, int j, int k, double inverse,
                               double li, double lj)
{
    double l = li * inverse, rest = a - l * lj, row = lj * inverse;
    row = j == k ? -inverse : row;
    rest = j == k ? l : rest;
    rest = i == k ? row : rest;
    return inverse == 0 ? a : rest;
}

/* Two columns, k and k + 1, of the matrix before they are swept. The last place
 * belongs to entries that no matrix has. */
struct columns {
    double of[2][DENSE + 1];
};

/* Entry i of column k + 1 after unknown k is swept. */
static __device__ double next_column(const struct columns *c, int i, int k,
                                     double inverse)
{
    const double *l = c->of[0];
    int row = i > k ? i : k + 1, column = i > k ? k + 1 : i;
    return swept(c->of[1][i], row, column, k, inverse, l[row], l[column]);
}

/* Keeps an entry where it belongs to column k or k + 1. */
static __device__ void keep(struct columns *c, double a, int i, int j, int k)
{
    for (int e = 0; e < 2; e++) {
        if (j == k + e)
            c->of[e][i] = a;
        else if (i == k + e)
            c->of[e][j] = a;
    }
}

/* Run by one block. Each thread keeps its entries in registers, and sweeps two
 * unknowns between two barriers: it finds the second's column itself. Whoever
 * has entries of the next two columns writes them for all. */
KERNEL coarsest_invert_kernel(const struct coarsest &s)
{
    __shared__ double diagonal[DENSE];
    __shared__ struct columns columns[2];
    __shared__ sym block[(STENCIL + 1) * COARSEST];
    __shared__ bool parked[DENSE]; /* not swept */
    int n = 3 * (int)s.count, t = (int)threadIdx.x, row[OWN], col[OWN];
    int blocks = STENCIL * (int)s.count;
    double a[OWN], least = 0;
    for (int e = t; e < blocks + (int)s.count; e += INVERT_BLOCK)
        block[e] = e < blocks ? s.block[e] : s.excess[e - blocks];
    __syncthreads();
    UNROLL
    for (int o = 0; o < OWN; o++) {
        place_entry(t + o * INVERT_BLOCK, &row[o], &col[o]);
        a[o] = 0;
        if (row[o] >= n) {
            row[o] = col[o] = DENSE;
            continue;
        }
        a[o] = coarsest_entry(&s, block, block + blocks, row[o], col[o]);
        if (row[o] == col[o])
            diagonal[row[o]] = a[o];
        keep(&columns[0], a[o], row[o], col[o], 0);
    }
    __syncthreads();
    for (int k = 0; k < n; k++)
        least += diagonal[k];
    least *= 0x1p-40;
    for (int k = 0; k < n; k += 2) {
        const struct columns *c = &columns[k / 2 % 2];
        double first = inverse_of(c->of[0][k], least), second = 0;
        if (k + 1 < n)
            second = inverse_of(next_column(c, k + 1, k, first), least);
        if (t < 2 && k + t < n)
            parked[k + t] = (t ? second : first) == 0;
        UNROLL
        for (int o = 0; o < OWN; o++) {
            int i = row[o], j = col[o];
            a[o] = swept(a[o], i, j, k, first, c->of[0][i], c->of[0][j]);
            a[o] = swept(a[o], i, j, k + 1, second, next_column(c, i, k, first),
                         next_column(c, j, k, first));
            if (k + 2 < n)
                keep(&columns[(k / 2 + 1) % 2], a[o], i, j, k + 2);
        }
        __syncthreads();
    }
    UNROLL
    for (int o = 0; o < OWN; o++) {
        int i = row[o], j = col[o];
        if (i >= n)
            continue;
        double e = parked[i] || parked[j] ? 0 : -a[o];
        s.dense[i * DENSE + j] = s.dense[j * DENSE + i] = e;
    }
}

void gpu_coarsest_invert(struct gpu *g, const struct coarsest *s)
{
    MERGE_BLOCKS(g, 1, INVERT_BLOCK, INVERT_BLOCK, 1, (*s),
                 coarsest_invert_kernel);
}
