/* SPDX-License-Identifier: Apache-2.0 */
/* The product of spec/12_product.md §1 for a whole grid: blocks march down
 * strips of columns and meet each tie once, which both its ends then add in
 * their own order. Who marches reads 24 bytes a tie where a gather reads 48,
 * and does half the arithmetic. */
#ifndef GPU_MARCH_CUH
#define GPU_MARCH_CUH

#include "gpu/ties.cuh"

/* REACH: columns and rows that a tie spans at most. MARCH_LEAST, MARCH_WIDE:
 * particles and columns from which on it pays; MARCH_UNITS: multiprocessors, or
 * as many as are cut for. */
#ifdef __CUDACC__
enum { REACH = 2, MARCH_LEAST = 1 << 17, MARCH_WIDE = 96, MARCH_UNITS = 132 };
#else
enum { REACH = 2, MARCH_LEAST = 256, MARCH_WIDE = 2, MARCH_UNITS = 2 };
#endif

/* A block's memory: X_ROWS rows of x and, of two rows, the pulls of ties that
 * lead to another column. Its threads, a column each, have 48 KiB of it, and
 * there are not more of them at once than leaves each the registers to read
 * ahead: 128 for thin blocks of binary32, which need fewer. */
enum { X_ROWS = 4 };
template <int TIES, class B> struct march_size {
    static constexpr bool slim = REAL_BITS == 32 && sizeof(B) < sizeof(sym);
    static constexpr int at_once = slim ? 4 : 2; /* of a multiprocessor */
    static constexpr int limit = slim ? 128 : 192;
    static constexpr int passed = TIES == SPRINGS ? 6 : 10;
    static constexpr int bytes = (2 * passed + X_ROWS) * (int)sizeof(vec);
    static constexpr int fit = 49152 / bytes / 64 * 64;
    static constexpr int threads = fit < limit ? fit : limit;
};

/* How a grid is cut: strips of columns, rows of a block. */
struct cut {
    int strips, width, rows;
};

/* Tie o among those that lead to another column, in order. */
template <int TIES> static __host__ __device__ constexpr int passed_at(int o)
{
    if (TIES == SPRINGS)
        return o == 0 ? 0 : o < 5 ? o - 1 : o - 2;
    return o < 4 ? o : o < 9 ? o - 1 : o - 2;
}

/* Whether registers hold what a row reads besides its ties a while ahead. */
enum { MARCH_AHEAD = REAL_BITS == 32 };

/* What a thread carries down its column, all in registers. A pull that nobody
 * wants is +0: to add or subtract it changes no y, which is never -0. */
template <int TIES, class B> struct marcher {
    int lane, i, j, top; /* top: the first row that the block owns */
    struct grid g;
    unsigned out;    /* bit o: tie o leads to a column of strip and grid */
    unsigned wanted; /* bit o: and someone wants its pull from the row of */
    B block[TIES];   /* row j, or the row below once row j has pulled */
    vec pull[TIES];  /* of row j */
    vec one[TIES];   /* of the row above, by ties that end here */
    vec two[TIES], older[TIES]; /* likewise of the two rows above */
    vec here;                   /* x of row j */
};

/* Which ties lead from a column to columns of its strip and grid. */
template <int TIES, class B>
static __device__ inline unsigned columns(const struct marcher<TIES, B> *w,
                                          int width)
{
    unsigned mask = 0;
    UNROLL
    for (int o = 0; o < TIES; o++) {
        int di = toward_i<TIES>(o);
        if ((unsigned)w->i < (unsigned)w->g.m &&
            (unsigned)(w->i + di) < (unsigned)w->g.m &&
            (unsigned)(w->lane + di) < (unsigned)(width + 2 * REACH))
            mask |= 1u << o;
    }
    return mask;
}

/* Which of them lead from row j to rows that the block owns. */
template <int TIES, class B>
static __device__ inline unsigned rows(const struct marcher<TIES, B> *w, int j)
{
    unsigned mask = 0;
    UNROLL
    for (int o = 0; o < TIES; o++) {
        int end = j + toward_j<TIES>(o);
        mask |= end >= w->top && end < w->g.n ? 1u << o : 0;
    }
    return mask;
}

template <int TIES, class B>
static __device__ inline void fetch_row(struct marcher<TIES, B> *w,
                                        const B *block, int j)
{
    int64_t count = (int64_t)w->g.m * w->g.n;
    int p = w->i + w->g.m * j;
    w->wanted = w->out & rows(w, j);
    UNROLL
    for (int o = 0; o < TIES; o++)
        w->block[o] =
            fetch_once(block + o * count + (w->wanted >> o & 1 ? p : 0));
}

/* The column's particle of row j, or one near where there is none. */
template <int TIES, class B>
static __device__ inline struct place place_in(const struct marcher<TIES, B> *w,
                                               int j)
{
    int i = least(most(w->i, 0), w->g.m - 1);
    j = least(j, w->g.n - 1);
    return place{i + w->g.m * j, i, j};
}

/* B (x_p - x_q) of all ties that start in row j. */
template <int TIES, class B, int THREADS>
static __device__ inline void pull_row(struct marcher<TIES, B> *w,
                                       const vec (*x)[THREADS],
                                       vec (*passed)[THREADS])
{
    w->here = x[w->j % X_ROWS][w->lane];
    UNROLL
    for (int o = 0; o < TIES; o++) {
        int di = toward_i<TIES>(o), dj = toward_j<TIES>(o);
        int lane = least(most(w->lane + di, 0), THREADS - 1);
        vec there = x[(w->j + dj) % X_ROWS][lane];
        vec f = apply(w->block[o], sub(w->here, there));
        w->pull[o] = w->wanted >> o & 1 ? f : make(0, 0, 0);
        if (di != 0)
            passed[passed_at<TIES>(o)][w->lane] = w->pull[o];
    }
}

/* The pull of row j by tie o that ends in this column, below or beside. */
template <int TIES, class B, int THREADS>
static __device__ inline vec pull_at(const struct marcher<TIES, B> *w,
                                     const vec (*passed)[THREADS], int o)
{
    int di = toward_i<TIES>(o);
    return di ? passed[passed_at<TIES>(o)][w->lane - di] : w->pull[o];
}

/* y of row j plus its ties' pulls, in their order. */
template <int TIES, class B, int THREADS>
static __device__ inline vec add_pulls(const struct marcher<TIES, B> *w,
                                       const vec (*passed)[THREADS], vec y)
{
    UNROLL
    for (int o = 0; o < TIES; o++) {
        int dj = toward_j<TIES>(o);
        y = sub(y, dj == 0   ? pull_at(w, passed, o)
                   : dj == 1 ? w->one[o]
                             : w->older[o]);
        y = add(y, w->pull[o]);
    }
    return y;
}

/* What ends one or two rows below is kept till there. */
template <int TIES, class B, int THREADS>
static __device__ inline void keep_pulls(struct marcher<TIES, B> *w,
                                         const vec (*passed)[THREADS])
{
    UNROLL
    for (int o = 0; o < TIES; o++) {
        int dj = toward_j<TIES>(o);
        if (dj == 1)
            w->one[o] = pull_at(w, passed, o);
        if (dj == 2) {
            w->older[o] = w->two[o];
            w->two[o] = pull_at(w, passed, o);
        }
    }
}

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
    __shared__ vec row[X_ROWS][march_size<TIES, B>::threads];
    __shared__ vec
        passed[2][march_size<TIES, B>::passed][march_size<TIES, B>::threads];
    struct marcher<TIES, B> w = {
    };
    if (go && !*go)
        return;
    int strip = (int)blockIdx.x % c.strips, lane = (int)threadIdx.x;
    w.lane = lane;
    w.g = t.g;
    w.i = strip * c.width + lane - REACH;
    w.out = columns(&w, c.width);
    w.top = (int)blockIdx.x / c.strips * c.rows;
    w.j = most(w.top - REACH, 0);
    int bottom = least(w.top + c.rows, t.g.n);
    bool mine = lane >= REACH && lane < c.width + REACH && w.i < t.g.m;
    for (int k = 0; k < X_ROWS - 1; k++)
        row[(w.j + k) % X_ROWS][lane] = value_at(&x, place_in(&w, w.j + k));
    /* What x of a row to come is made of is asked for while the row before it
     * is made, unless that takes too many registers. */
    decltype(take(&x, place_in(&w, 0))) come = {};
    constexpr bool EARLY =
        MARCH_AHEAD && !(march_size<TIES, B>::slim && sizeof come > 32);
    vec next = {};
    if (EARLY)
        come = take(&x, place_in(&w, w.j + X_ROWS - 1));
    else if (!MARCH_AHEAD)
        next = value_at(&x, place_in(&w, w.j + X_ROWS - 1));
    fetch_row(&w, t.block, w.j);
    __syncthreads();
    for (; w.j < bottom; w.j++) {
        vec(*pass)[march_size<TIES, B>::threads] = passed[w.j % 2];
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
        pull_row(&w, row, pass);
        if (w.j + 1 < bottom)
            fetch_row(&w, t.block, w.j + 1);
        row[(w.j + X_ROWS - 1) % X_ROWS][lane] =
            MARCH_AHEAD ? made(&x, come, place_in(&w, w.j + X_ROWS - 1)) : next;
        if (EARLY)
            come = take(&x, place_in(&w, w.j + X_ROWS));
        else if (!MARCH_AHEAD)
            next = value_at(&x, place_in(&w, w.j + X_ROWS));
        __syncthreads();
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

/* arrive(&end, place, …, x, A x) for all particles, in any order; nothing where
 * *go is 0, go being NULL or on the device. */
template <int TIES, class B, class X, class END>
static void march(struct gpu *g, struct ties<B> t, X x, END end,
                  const int32_t *go)
{
    const int most_wide = march_size<TIES, B>::threads - 2 * REACH;
    if (!marches(t.g)) {
        LAUNCH_BLOCKS(g, cut_up(t.g.m * t.g.n, GATHERED), GPU_BLOCK,
                      (gather_kernel<TIES, B, X, END>), t, x, end, go);
        return;
    }
    struct cut c;
    c.strips = cut_up(t.g.m, most_wide);
    c.width = cut_up(t.g.m, c.strips);
    c.rows = cut_up(t.g.n * c.strips,
                    march_size<TIES, B>::at_once * (int)MARCH_UNITS);
    int threads = cut_up(c.width + 2 * REACH, 32) * 32;
    LAUNCH_BLOCKS(g, c.strips * cut_up(t.g.n, c.rows), threads,
                  (march_kernel<TIES, B, X, END>), t, c, x, end, go);
}

#endif
