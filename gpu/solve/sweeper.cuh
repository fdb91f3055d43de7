/* SPDX-License-Identifier: Apache-2.0 */
/* A thread that goes down a column of a grid in a sweep (gpu/solve/sweep.cuh):
 * the edges that it reads, their pulls B (x_p - x_q), and the pulls that it
 * passes to threads of other columns. spec/solve/product.md §1 */
#ifndef GPU_SWEEPER_CUH
#define GPU_SWEEPER_CUH

#include "gpu/base/bulk.cuh"
#include "gpu/cloth/rate.cuh"

/* REACH: the most columns and rows that an edge spans. SWEEP_LEAST, SWEEP_WIDE:
 * a sweep is faster than a gather for grids of at least so many particles and
 * columns. SWEEP_UNITS: the number of multiprocessors for which a grid is cut.
 */
#ifdef __CUDACC__
enum { REACH = 2, SWEEP_LEAST = 1 << 17, SWEEP_WIDE = 96, SWEEP_UNITS = 132 };
#else
enum { REACH = 2, SWEEP_LEAST = 256, SWEEP_WIDE = 2, SWEEP_UNITS = 2 };
#endif

/* How a thread keeps its edges. Their blocks are kept in
 * registers; rates in binary32 are staged, that is, kept as STAGES rows in
 * shared memory, since they take longer to use. at_once, limit: how many blocks
 * of at most how many threads run on a multiprocessor. They are so few that
 * each thread has registers to read ahead. */
enum { STAGES = 2 };
template <class B> struct carried {
    static constexpr bool staged = false;
    static constexpr bool slim = REAL_BITS == 32 && sizeof(B) < sizeof(sym);
    static constexpr int at_once = slim ? 4 : 2, limit = slim ? 128 : 192;
};

template <> struct carried<struct rate> {
    static constexpr bool staged = REAL_BITS == 32, slim = false;
    static constexpr int at_once = staged ? 5 : 4, limit = staged ? 96 : 128;
};

/* The sizes of a sweep. The shared memory of a block, at most 48 KiB, holds
 * X_ROWS rows of particles, two rows of the pulls of edges that lead to another
 * column, and the staged edges. */
enum { X_ROWS = 4 };
template <int EDGES, class B> struct sweep_size : carried<B> {
    static constexpr bool staged = carried<B>::staged;
    static constexpr int limit = carried<B>::limit;
    static constexpr int passed = EDGES == SPRINGS ? 6 : 10;
    static constexpr int bytes = 2 * passed * (int)sizeof(vec) +
                                 X_ROWS * (int)sizeof(vec) +
                                 (staged ? STAGES * EDGES * (int)sizeof(B) : 0);
    static constexpr int fit = 49152 / bytes / 64 * 64;
    static constexpr int threads = staged || fit > limit ? limit : fit;
    static constexpr int pitch = staged ? threads : 1;
};

/* The staged edges of the current and the next row: row j is in stage j %
 * STAGES. */
template <int EDGES, class B> struct staging {
    enum {
        ROWS = sweep_size<EDGES, B>::staged ? STAGES : 1,
        EACH = sweep_size<EDGES, B>::staged ? EDGES : 1,
        PITCH = sweep_size<EDGES, B>::pitch
    };
    alignas(16) B edge[ROWS][EACH][PITCH];
    bulk row[ROWS];
};

/* How a grid is cut into strips of columns, and strips into blocks of rows. */
struct cut {
    int strips, width, rows;
};

/* Returns the number of edge o among the edges that lead to another column. */
template <int EDGES> static __host__ __device__ constexpr int passed_at(int o)
{
    if (EDGES == SPRINGS)
        return o == 0 ? 0 : o < 5 ? o - 1 : o - 2;
    return o < 4 ? o : o < 9 ? o - 1 : o - 2;
}

/* Whether a row's inputs other than edges are read ahead into registers. */
enum { SWEEP_AHEAD = REAL_BITS == 32 };

/* The state that a thread carries down its column, in registers. A pull that is
 * not needed is +0: adding or subtracting +0 changes no y, as y is never -0. */
template <int EDGES, class B> struct sweeper {
    int lane, i, j, top; /* i: column; j: row; top: first row of the block */
    int low, end;        /* the columns whose edges are staged */
    struct grid g;
    unsigned out;    /* bit o: edge o leads to a column of strip and grid */
    unsigned wanted; /* bit o: the pull of edge o of the row that is in `block`
                        is needed */
    /* The blocks of row j; after pull_row and fetch_row those of row j + 1. Not
     * used if edges are staged. */
    B block[sweep_size<EDGES, B>::staged ? 1 : EDGES];
    vec pull[EDGES]; /* pulls of the edges that start in row j */
    vec one[EDGES];  /* pulls from row j - 1, of edges that end here */
    vec two[EDGES], older[EDGES]; /* pulls from rows j - 1 and j - 2, of edges
                                     that end two rows below their start */
    vec here;                     /* x of row j */
};

/* Returns a mask: bit o is set if edge o leads from this column to a column of
 * the strip and the grid. */
template <int EDGES, class B>
static __device__ inline unsigned columns(const struct sweeper<EDGES, B> *w,
                                          int width)
{
    unsigned mask = 0;
    UNROLL
    for (int o = 0; o < EDGES; o++) {
        int di = toward_i<EDGES>(o);
        if ((unsigned)w->i < (unsigned)w->g.m &&
            (unsigned)(w->i + di) < (unsigned)w->g.m &&
            (unsigned)(w->lane + di) < (unsigned)(width + 2 * REACH))
            mask |= 1u << o;
    }
    return mask;
}

/* Returns a mask: bit o is set if edge o leads from row j to a row that the
 * block owns or that lies below it in the grid. */
template <int EDGES, class B>
static __device__ inline unsigned rows(const struct sweeper<EDGES, B> *w, int j)
{
    unsigned mask = 0;
    UNROLL
    for (int o = 0; o < EDGES; o++) {
        int end = j + toward_j<EDGES>(o);
        mask |= end >= w->top && end < w->g.n ? 1u << o : 0;
    }
    return mask;
}

/* Sets which edges of row j are needed, and reads them unless they are staged.
 */
template <int EDGES, class B>
static __device__ inline void fetch_row(struct sweeper<EDGES, B> *w,
                                        const B *block, int j)
{
    int p = w->i + w->g.m * j;
    w->wanted = w->out & rows(w, j);
    UNROLL
    for (int o = 0; o < EDGES && !sweep_size<EDGES, B>::staged; o++)
        w->block[o] = fetch_once(block + (int64_t)o * w->g.m * w->g.n +
                                 (w->wanted >> o & 1 ? p : 0));
}

/* Starts the copies of the staged edges of row j: thread o copies edge o, or
 * nothing if edge o does not lead to rows that the block owns. */
template <int EDGES, class B>
static __device__ inline void ask_row(const struct sweeper<EDGES, B> *w,
                                      const B *block,
                                      struct staging<EDGES, B> *s, int j)
{
    int o = w->lane, stage = j % STAGES;
    if (o >= EDGES)
        return;
    const B *from = block + ((int64_t)o * w->g.n + j) * w->g.m + w->low;
    bool wanted = j + toward_j<EDGES>(o) >= w->top;
    bulk_ask(&s->row[stage], s->edge[stage][o], from,
             wanted ? (w->end - w->low) * (int)sizeof(B) : 0);
}

/* Returns the particle of this column in row j, or a nearby one if there is
 * none. */
template <int EDGES, class B>
static __device__ inline struct place
place_in(const struct sweeper<EDGES, B> *w, int j)
{
    int i = min_of(max_of(w->i, 0), w->g.m - 1);
    j = min_of(j, w->g.n - 1);
    return place{i + w->g.m * j, i, j};
}

/* Computes the pulls B (x_p - x_q) of all edges that start in row j. */
template <int EDGES, class B, int THREADS>
static __device__ inline void
pull_row(struct sweeper<EDGES, B> *w, const struct staging<EDGES, B> *s,
         const vec (*x)[THREADS], vec (*passed)[THREADS])
{
    constexpr bool staged = sweep_size<EDGES, B>::staged;
    vec here = x[w->j % X_ROWS][w->lane];
    int column = max_of(min_of(w->i, w->end - 1), w->low) - w->low;
    int at = staged ? column : 0;
    w->here = here;
    UNROLL
    for (int o = 0; o < EDGES; o++) {
        int di = toward_i<EDGES>(o), dj = toward_j<EDGES>(o);
        int lane = min_of(max_of(w->lane + di, 0), THREADS - 1);
        B b = staged ? s->edge[w->j % STAGES][staged ? o : 0][at]
                     : w->block[staged ? 0 : o];
        vec f = edge_pull(b, here, x[(w->j + dj) % X_ROWS][lane]);
        w->pull[o] = w->wanted >> o & 1 ? f : make(0, 0, 0);
        if (di != 0)
            passed[passed_at<EDGES>(o)][w->lane] = w->pull[o];
    }
}

/* Returns the pull of the edge o that starts in row j and ends in this column.
 */
template <int EDGES, class B, int THREADS>
static __device__ inline vec pull_at(const struct sweeper<EDGES, B> *w,
                                     const vec (*passed)[THREADS], int o)
{
    int di = toward_i<EDGES>(o);
    return di ? passed[passed_at<EDGES>(o)][w->lane - di] : w->pull[o];
}

/* Returns y of row j plus the pulls of its edges, in the order of §1. */
template <int EDGES, class B, int THREADS>
static __device__ inline vec add_pulls(const struct sweeper<EDGES, B> *w,
                                       const vec (*passed)[THREADS], vec y)
{
    UNROLL
    for (int o = 0; o < EDGES; o++) {
        int dj = toward_j<EDGES>(o);
        y = sub(y, dj == 0   ? pull_at(w, passed, o)
                   : dj == 1 ? w->one[o]
                             : w->older[o]);
        y = add(y, w->pull[o]);
    }
    return y;
}

/* Keeps the pulls of edges that end one or two rows below. */
template <int EDGES, class B, int THREADS>
static __device__ inline void keep_pulls(struct sweeper<EDGES, B> *w,
                                         const vec (*passed)[THREADS])
{
    UNROLL
    for (int o = 0; o < EDGES; o++) {
        int dj = toward_j<EDGES>(o);
        if (dj == 1)
            w->one[o] = pull_at(w, passed, o);
        if (dj == 2) {
            w->older[o] = w->two[o];
            w->two[o] = pull_at(w, passed, o);
        }
    }
}

#endif
