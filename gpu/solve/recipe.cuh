/* SPDX-License-Identifier: Apache-2.0 */
/* Recipes. A recipe lists the fine blocks, and their weights, that add up to a
 * coarse block where no rule changes the interpolation. The host makes them
 * once. spec/solve/multigrid.md §2 */
#ifndef GPU_RECIPE_CUH
#define GPU_RECIPE_CUH

#include "gpu/solve/grid.cuh"

/* One term: weight / 16 times block o of the fine particle that lies (di, dj)
 * fine steps from the coarse particle. */
struct term {
    int8_t o, di, dj, weight;
};

/* TERMS: the most terms of one coarse direction. AROUND: the number of fine
 * places where an edge that contributes to a coarse particle can start. */
enum { TERMS = 64, AROUND = 7 * 5 };
struct recipe {
    int terms;
    struct term term[TERMS];
};
struct book {
    struct recipe recipe[STENCIL];
};

/* Returns four times the bilinear weight that the fine particle at (i, j) gives
 * to a coarse particle at (0, 0). */
static __host__ __device__ constexpr int hat(int i, int j)
{
    int a = i < 0 ? -i : i, b = j < 0 ? -j : j;
    return (a < 2 ? 2 - a : 0) * (b < 2 ? 2 - b : 0);
}

/* Returns 16 times the factor of fine edge o in coarse direction `to`:
 * -(wᵢ - wᵢ')(wⱼ - wⱼ'), where i is the coarse particle, j the coarse particle
 * in that direction, and the dash marks the weight at the edge's other end. The
 * edge starts (di, dj) fine steps from the coarse particle. */
template <int EDGES>
static __host__ __device__ constexpr int factor_of(int o, int di, int dj,
                                                   int to)
{
    int ci = 2 * toward_i<STENCIL>(to), cj = 2 * toward_j<STENCIL>(to);
    int zi = di + toward_i<EDGES>(o), zj = dj + toward_j<EDGES>(o);
    return -(hat(di, dj) - hat(zi, zj)) *
           (hat(di - ci, dj - cj) - hat(zi - ci, zj - cj));
}

/* Returns the offset of the k-th of the AROUND places. */
static __host__ __device__ constexpr int around_i(int k)
{
    return k % 7 - 3;
}

static __host__ __device__ constexpr int around_j(int k)
{
    return k / 7 - 3;
}

template <int EDGES> static void write_recipe(struct recipe *r, int to)
{
    memset((void *)r, 0, sizeof *r);
    for (int k = 0; k < EDGES * AROUND; k++) {
        int o = k / AROUND;
        int di = around_i(k % AROUND), dj = around_j(k % AROUND);
        int factor = factor_of<EDGES>(o, di, dj, to);
        struct term t = {(int8_t)o, (int8_t)di, (int8_t)dj, (int8_t)factor};
        if (factor != 0 && r->terms < TERMS)
            r->term[r->terms++] = t;
    }
}

template <int EDGES> static struct book write_book(void)
{
    struct book b;
    for (int o = 0; o < STENCIL; o++)
        write_recipe<EDGES>(&b.recipe[o], o);
    return b;
}

/* Returns the recipes of all directions. They are made once in a process, since
 * making them takes as long as the kernels of a grid. */
template <int EDGES> static const struct book *book_of(void)
{
    static const struct book book = write_book<EDGES>();
    return &book;
}

#endif
