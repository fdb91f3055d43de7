/* SPDX-License-Identifier: Apache-2.0 */
/* The product of spec/solve/product.md §1 for a whole grid (SpMV). Blocks sweep
 * down strips of columns, row by row, and read each edge once. Its pull is kept
 * until both ends have added it, each in its own order. A sweep reads 24 bytes
 * for an edge where a gather, which reads each edge at both ends, reads 48, and
 * does half the arithmetic. */
#ifndef GPU_SWEEP_CUH
#define GPU_SWEEP_CUH

#include "gpu/run/merge.cuh"
#include "gpu/solve/sweeper.cuh"

/* Block k owns `rows` rows of a strip of columns, one thread for each column;
 * it also computes the pulls of REACH columns to the left and right and of
 * REACH rows above. END is a type with two functions that use the rows of the
 * product: about(&end, place) reads what is needed at a place, and arrive(&end,
 * place, about(…), x, A x) uses the row. The thread that owns a particle calls
 * them, so that arrive may write there without a conflict. One barrier for each
 * row separates writes for other threads, to passed and x, from their reads:
 * the next row writes the other half of passed, and the place of x of row j -
 * 1, which nobody reads any more. */
template <int EDGES, class B, class X, class END>
KERNEL sweep_kernel(const struct edges<B> &t, const struct cut &c, const X &x,
                    const END &end, const int32_t *go)
{
    typedef sweep_size<EDGES, B> size;
    __shared__ vec row[X_ROWS][size::threads];
    __shared__ vec passed[2][size::passed][size::threads];
    __shared__ struct staging<EDGES, B> stage;
    struct sweeper<EDGES, B> w = {
    };
    if (go && !*go)
        return;
    int strip = (int)blockIdx.x % c.strips, lane = (int)threadIdx.x;
    w.lane = lane;
    w.g = t.g;
    w.i = strip * c.width + lane - REACH;
    w.low = max_of(strip * c.width - REACH, 0);
    w.end = min_of((strip + 1) * c.width + REACH, t.g.m);
    w.out = columns(&w, c.width);
    w.top = (int)blockIdx.x / c.strips * c.rows;
    w.j = max_of(w.top - REACH, 0);
    int bottom = min_of(w.top + c.rows, t.g.n);
    bool mine = lane >= REACH && lane < c.width + REACH && w.i < t.g.m;
    int first = w.j;
    if (size::staged) {
        if (lane < STAGES)
            bulk_open(&stage.row[lane], EDGES);
        __syncthreads();
        for (int k = first; k < first + STAGES && k < bottom; k++)
            ask_row(&w, t.block, &stage, k);
    }
    for (int k = 0; k < X_ROWS - 1; k++)
        row[(w.j + k) % X_ROWS][lane] = value_at(&x, place_in(&w, w.j + k));
    /* The inputs of x of the next row are read while this row is computed,
     * unless that takes too many registers. */
    decltype(take(&x, place_in(&w, 0))) come = {};
    constexpr bool EARLY = SWEEP_AHEAD && (!size::slim || sizeof come <= 32);
    vec next = {};
    if (EARLY)
        come = take(&x, place_in(&w, w.j + X_ROWS - 1));
    else if (!SWEEP_AHEAD)
        next = value_at(&x, place_in(&w, w.j + X_ROWS - 1));
    fetch_row(&w, t.block, w.j);
    __syncthreads();
    for (; w.j < bottom; w.j++) {
        vec(*pass)[(size::threads)] = passed[w.j % 2];
        struct place at = place_in(&w, w.j);
        decltype(about(&end, at)) own = {};
        struct base base = {};
        bool owns = mine && w.j >= w.top;
        if (SWEEP_AHEAD && !EARLY)
            come = take(&x, place_in(&w, w.j + X_ROWS - 1));
        if (SWEEP_AHEAD && owns) {
            own = about(&end, at);
            base = base_of<EDGES>(&t, at.p);
        }
        if (size::staged)
            bulk_wait(&stage.row[w.j % STAGES], (w.j - first) / STAGES);
        pull_row(&w, &stage, row, pass);
        if (w.j + 1 < bottom)
            fetch_row(&w, t.block, w.j + 1);
        row[(w.j + X_ROWS - 1) % X_ROWS][lane] =
            SWEEP_AHEAD ? made(&x, come, place_in(&w, w.j + X_ROWS - 1)) : next;
        if (EARLY)
            come = take(&x, place_in(&w, w.j + X_ROWS));
        else if (!SWEEP_AHEAD)
            next = value_at(&x, place_in(&w, w.j + X_ROWS));
        __syncthreads();
        if (size::staged && w.j + STAGES < bottom)
            ask_row(&w, t.block, &stage, w.j + STAGES);
        if (SWEEP_AHEAD && owns) {
            vec y = own_part<EDGES>(&t, base, w.here);
            arrive(&end, at, own, w.here, add_pulls(&w, pass, y));
        } else if (owns) {
            vec y = own_part<EDGES>(&t, base_of<EDGES>(&t, at.p), w.here);
            y = add_pulls(&w, pass, y);
            arrive(&end, at, about(&end, at), w.here, y);
        }
        if (mine)
            keep_pulls(&w, pass);
    }
}

/* Computes the product by a gather, for small grids: four adjacent lanes own a
 * particle, and the last of them calls arrive as above. Each edge is read
 * twice. */
enum { GATHER_LANES = 4, GATHERED = GPU_BLOCK / GATHER_LANES };
template <int EDGES, class B, class X, class END>
KERNEL gather_kernel(const struct edges<B> &t, const X &x, const END &end,
                     const int32_t *go)
{
    int lane = (int)threadIdx.x % GATHER_LANES, count = t.g.m * t.g.n;
    int item = (int)blockIdx.x * GATHERED + (int)threadIdx.x / GATHER_LANES;
    if (go && !*go)
        return;
    struct place at = place_of(t.g, item < count ? item : 0);
    auto own = about(&end, at);
    vec here, y = gathered<EDGES, GATHER_LANES>(&t, &x, at, lane, &here);
    if (item < count && lane == GATHER_LANES - 1)
        arrive(&end, at, own, here, y);
}

/* Whether the product of this grid sweeps; else it gathers. */
static inline bool sweeps(struct grid g)
{
    return (int64_t)g.m * g.n >= SWEEP_LEAST && g.m >= SWEEP_WIDE;
}

static inline int cut_up(int a, int parts)
{
    return (a + parts - 1) / parts;
}

/* Calls arrive(&end, place, …, x, A x) for all particles of a grid that sweeps,
 * in any order. go: NULL, or on the device; if *go is 0 nothing is done. */
template <int EDGES, class B, class X, class END>
static void sweep(struct gpu *g, struct edges<B> t, X x, END end,
                  const int32_t *go)
{
    const int most_wide = sweep_size<EDGES, B>::threads - 2 * REACH;
    struct cut c;
    c.strips = cut_up(t.g.m, most_wide);
    c.width = cut_up(t.g.m, c.strips);
    c.rows = cut_up(t.g.n * c.strips,
                    sweep_size<EDGES, B>::at_once * (int)SWEEP_UNITS);
    int threads = cut_up(c.width + 2 * REACH, 32) * 32;
    MERGE_BLOCKS(g, c.strips * cut_up(t.g.n, c.rows), threads,
                 (sweep_size<EDGES, B>::threads),
                 (sweep_size<EDGES, B>::at_once), (t, c, x, end, go),
                 sweep_kernel<EDGES, B, X, END>);
}

/* The same for any grid. */
template <int EDGES, class B, class X, class END>
static void product_of(struct gpu *g, struct edges<B> t, X x, END end,
                       const int32_t *go)
{
    if (sweeps(t.g))
        sweep<EDGES>(g, t, x, end, go);
    else
        MERGE_BLOCKS(g, cut_up(t.g.m * t.g.n, GATHERED), GPU_BLOCK, GPU_BLOCK,
                     1, (t, x, end, go), gather_kernel<EDGES, B, X, END>);
}

#endif
