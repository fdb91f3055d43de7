/* SPDX-License-Identifier: Apache-2.0 */
/* The product of spec/solve/product.md §1 for a whole grid: blocks march down
 * strips of columns and meet each tie once, which both its ends then add in
 * their own order. Who marches reads 24 bytes a tie where a gather reads 48,
 * and does half the arithmetic. */
#ifndef GPU_MARCH_CUH
#define GPU_MARCH_CUH

#include "gpu/solve/marcher.cuh"

/* Block k owns `rows` rows of a strip of columns, a thread a column, and those
 * REACH to the left and right and above for what they pull. For each particle
 * that it owns arrive(&end, place, about(&end, place), x, A x) is called, by
 * the same thread that alone may write there. Of a row the barrier parts what
 * is written for others, into passed and x, from its reading; the next row
 * writes passed to the other half, and x where row j - 1 was, which none
 * reads any more. */
template <int TIES, class B, class X, class END>
static __global__ void __launch_bounds__(march_size<TIES, B>::threads,
                                         march_size<TIES, B>::at_once)
    march_kernel(struct ties<B> t, struct cut c, X x, END end,
                 const int32_t *go)
{
    typedef march_size<TIES, B> size;
    __shared__ typename size::spot row[X_ROWS][size::threads];
    __shared__ vec passed[2][size::passed][size::threads];
    __shared__ struct staging<TIES, B> stage;
    struct marcher<TIES, B> w = {
    };
    if (go && !*go)
        return;
    int strip = (int)blockIdx.x % c.strips, lane = (int)threadIdx.x;
    w.lane = lane;
    w.g = t.g;
    w.i = strip * c.width + lane - REACH;
    w.low = most(strip * c.width - REACH, 0);
    w.end = least((strip + 1) * c.width + REACH, t.g.m);
    w.out = columns(&w, c.width);
    w.top = (int)blockIdx.x / c.strips * c.rows;
    w.j = most(w.top - REACH, 0);
    int bottom = least(w.top + c.rows, t.g.n);
    bool mine = lane >= REACH && lane < c.width + REACH && w.i < t.g.m;
    int first = w.j;
    if (size::staged) {
        if (lane < STAGES)
            bulk_open(&stage.row[lane], TIES);
        __syncthreads();
        for (int k = first; k < first + STAGES && k < bottom; k++)
            ask_row(&w, t.block, &stage, k);
    }
    for (int k = 0; k < X_ROWS - 1; k++)
        row[(w.j + k) % X_ROWS][lane] = value_at(&x, place_in(&w, w.j + k));
    /* What x of a row to come is made of is asked for while the row before it
     * is made, unless that takes too many registers. */
    decltype(take(&x, place_in(&w, 0))) come = {};
    constexpr bool EARLY = MARCH_AHEAD && (!size::slim || sizeof come <= 32);
    typename size::spot next = {};
    if (EARLY)
        come = take(&x, place_in(&w, w.j + X_ROWS - 1));
    else if (!MARCH_AHEAD)
        next = value_at(&x, place_in(&w, w.j + X_ROWS - 1));
    fetch_row(&w, t.block, w.j);
    __syncthreads();
    for (; w.j < bottom; w.j++) {
        vec(*pass)[(size::threads)] = passed[w.j % 2];
        struct place at = place_in(&w, w.j);
        decltype(about(&end, at)) own = {};
        struct base base = {};
        bool owns = mine && w.j >= w.top;
        if (MARCH_AHEAD && !EARLY)
            come = take(&x, place_in(&w, w.j + X_ROWS - 1));
        if (MARCH_AHEAD && owns) {
            own = about(&end, at);
            base = base_of<TIES>(&t, at.p);
        }
        if (size::staged)
            bulk_wait(&stage.row[w.j % STAGES], (w.j - first) / STAGES);
        pull_row(&w, &stage, row, pass);
        if (w.j + 1 < bottom)
            fetch_row(&w, t.block, w.j + 1);
        row[(w.j + X_ROWS - 1) % X_ROWS][lane] =
            MARCH_AHEAD ? made(&x, come, place_in(&w, w.j + X_ROWS - 1)) : next;
        if (EARLY)
            come = take(&x, place_in(&w, w.j + X_ROWS));
        else if (!MARCH_AHEAD)
            next = value_at(&x, place_in(&w, w.j + X_ROWS));
        __syncthreads();
        if (size::staged && w.j + STAGES < bottom)
            ask_row(&w, t.block, &stage, w.j + STAGES);
        if (MARCH_AHEAD && owns) {
            vec y = own_part<TIES>(&t, base, w.here);
            arrive(&end, at, own, w.here, add_pulls(&w, pass, y));
        } else if (owns) {
            vec y = own_part<TIES>(&t, base_of<TIES>(&t, at.p), w.here);
            y = add_pulls(&w, pass, y);
            arrive(&end, at, about(&end, at), w.here, y);
        }
        if (mine)
            keep_pulls(&w, pass);
    }
}

/* Four neighbours own a particle, for which one calls arrive as above; each tie
 * is met twice. */
enum { GATHER_LANES = 4, GATHERED = GPU_BLOCK / GATHER_LANES };
template <int TIES, class B, class X, class END>
static __global__ void __launch_bounds__(GPU_BLOCK)
    gather_kernel(struct ties<B> t, X x, END end, const int32_t *go)
{
    int lane = (int)threadIdx.x % GATHER_LANES, count = t.g.m * t.g.n;
    int item = (int)blockIdx.x * GATHERED + (int)threadIdx.x / GATHER_LANES;
    if (go && !*go)
        return;
    struct place at = place_of(t.g, item < count ? item : 0);
    auto own = about(&end, at);
    vec here, y = gathered<TIES, GATHER_LANES>(&t, &x, at, lane, &here);
    if (item < count && lane == GATHER_LANES - 1)
        arrive(&end, at, own, here, y);
}

/* Whether the product of a grid marches. */
static inline bool marches(struct grid g)
{
    return (int64_t)g.m * g.n >= MARCH_LEAST && g.m >= MARCH_WIDE;
}

static inline int cut_up(int a, int parts)
{
    return (a + parts - 1) / parts;
}

/* arrive(&end, place, …, x, A x) for all particles of a grid that marches, in
 * any order; nothing where *go is 0, go being NULL or on the device. */
template <int TIES, class B, class X, class END>
static void march(struct gpu *g, struct ties<B> t, X x, END end,
                  const int32_t *go)
{
    const int most_wide = march_size<TIES, B>::threads - 2 * REACH;
    struct cut c;
    c.strips = cut_up(t.g.m, most_wide);
    c.width = cut_up(t.g.m, c.strips);
    c.rows = cut_up(t.g.n * c.strips,
                    march_size<TIES, B>::at_once * (int)MARCH_UNITS);
    int threads = cut_up(c.width + 2 * REACH, 32) * 32;
    LAUNCH_BLOCKS(g, c.strips * cut_up(t.g.n, c.rows), threads,
                  (march_kernel<TIES, B, X, END>), t, c, x, end, go);
}

/* The same for any grid. */
template <int TIES, class B, class X, class END>
static void product_of(struct gpu *g, struct ties<B> t, X x, END end,
                       const int32_t *go)
{
    if (marches(t.g))
        march<TIES>(g, t, x, end, go);
    else
        LAUNCH_BLOCKS(g, cut_up(t.g.m * t.g.n, GATHERED), GPU_BLOCK,
                      (gather_kernel<TIES, B, X, END>), t, x, end, go);
}

#endif
