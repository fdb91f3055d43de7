/* SPDX-License-Identifier: Apache-2.0 */
/* Applies the recipes of spec/solve/multigrid.md §2 to a tile of coarse
 * particles at once. A thread block reads the fine blocks around its tile once,
 * to shared memory; without tiles each thread would read 140 or 244 blocks. */
#ifndef GPU_TILE_CUH
#define GPU_TILE_CUH

#include <utility>

#include "gpu/solve/galerkin.cuh"

/* TILE_I, TILE_J: coarse particles of a tile along i and j. TILE_WIDE,
 * TILE_HIGH: the columns, of even or of odd number, and the rows of fine
 * particles whose edges may contribute to the tile. Even and odd columns are
 * stored apart, so that neighbouring threads read neighbouring words. */
enum {
    TILE_I = 32,
    TILE_J = REAL_BITS == 32 ? 8 : 4,
    TILE_BLOCK = TILE_I * TILE_J,
    TILE_WIDE = TILE_I + 3,
    TILE_HIGH = 2 * TILE_J + 3,
    SYM = 6 /* numbers of a block */
};

struct tile {
    real a[SYM][TILE_HIGH][2][TILE_WIDE];
};

static_assert(sizeof(struct tile) <= 49152, "a block's shared memory");

/* A thread's coarse particle and its sums. */
struct sums {
    struct place at; /* at.p is set only if there is such a particle */
    int i, j;        /* place in the tile */
    sym sum[STENCIL];
    sym excess;
};

static __device__ inline void set_at(struct tile *t, int x, int y, sym b)
{
    t->a[0][y][x % 2][x / 2] = b.xx;
    t->a[1][y][x % 2][x / 2] = b.xy;
    t->a[2][y][x % 2][x / 2] = b.xz;
    t->a[3][y][x % 2][x / 2] = b.yy;
    t->a[4][y][x % 2][x / 2] = b.yz;
    t->a[5][y][x % 2][x / 2] = b.zz;
}

/* Returns the block of the edge that starts (di, dj) fine steps from coarse
 * particle (i, j) of the tile. */
static __device__ inline sym at_tile(const struct tile *t, int i, int j, int di,
                                     int dj)
{
    int x = 2 * i + di + 3, y = 2 * j + dj + 3;
    return sym{t->a[0][y][x % 2][x / 2], t->a[1][y][x % 2][x / 2],
               t->a[2][y][x % 2][x / 2], t->a[3][y][x % 2][x / 2],
               t->a[4][y][x % 2][x / 2], t->a[5][y][x % 2][x / 2]};
}

/* Reads the blocks of direction o around the tile to shared memory. Edges that
 * are not live or not in the grid get 0, which changes no sum; live: NULL if
 * all are live. AHEAD blocks are read before the first one is stored, to hide
 * the latency of memory. */
static __device__ inline void read_tile(struct tile *t, const struct coarsen *s,
                                        struct place corner, const sym *block,
                                        const uint8_t *live, int o)
{
    enum { AHEAD = 3, WIDE = 2 * TILE_WIDE, COUNT = WIDE * TILE_HIGH };
    struct grid f = {s->m, s->n};
    for (int first = (int)threadIdx.x; first < COUNT;
         first += AHEAD * TILE_BLOCK) {
        sym b[AHEAD];
        bool good[AHEAD];
        UNROLL
        for (int k = 0; k < AHEAD; k++) {
            int at = first + k * TILE_BLOCK;
            int i = 2 * corner.i - 3 + at % WIDE;
            int j = 2 * corner.j - 3 + at / WIDE;
            good[k] = within(f, i, j);
            int p = good[k] ? i + f.m * j : 0;
            b[k] = fetch(block + p);
            good[k] = good[k] && (!live || live[p] >> o & 1);
        }
        UNROLL
        for (int k = 0; k < AHEAD; k++) {
            int at = first + k * TILE_BLOCK;
            if (at < COUNT)
                set_at(t, at % WIDE, at / WIDE,
                       good[k] ? b[k] : sym{0, 0, 0, 0, 0, 0});
        }
    }
}

/* The functions below are expanded for all edges, places and directions at
 * compile time. C++14 has no fold expressions; so each function returns a bool,
 * and a call for each index initialises an array of them, which C++ evaluates
 * in order. */

/* Whether some coarse block has a term of the edge o that starts at the k-th of
 * the AROUND places. */
template <int EDGES> static __device__ constexpr bool used(int o, int k)
{
    bool any = false;
    for (int to = 0; to < STENCIL; to++)
        any |= factor_of<EDGES>(o, around_i(k), around_j(k), to) != 0;
    return any;
}

/* Adds the term of the edge O that starts at the K-th place, whose block is b,
 * to coarse direction TO. */
template <int EDGES, int O, int K, int TO>
static __device__ inline bool add_term(struct sums *c, sym b)
{
    constexpr int w = factor_of<EDGES>(O, around_i(K), around_j(K), TO);
    if (w != 0)
        c->sum[TO] = plus(c->sum[TO], (real)w * R(0.0625), b);
    return w != 0;
}

template <int EDGES, int O, int K, int... TO>
static __device__ inline bool add_edge(struct sums *c, const struct tile *t,
                                       std::integer_sequence<int, TO...>)
{
    constexpr bool wanted = used<EDGES>(O, K);
    if (wanted) {
        sym b = at_tile(t, c->i, c->j, around_i(K), around_j(K));
        const bool each[] = {add_term<EDGES, O, K, TO>(c, b)...};
        (void)each;
    }
    return wanted;
}

template <int EDGES, int O, int... K>
static __device__ inline void add_edges(struct sums *c, const struct tile *t,
                                        std::integer_sequence<int, K...>)
{
    typedef std::make_integer_sequence<int, STENCIL> directions;
    const bool each[] = {add_edge<EDGES, O, K>(c, t, directions{})...};
    (void)each;
}

/* Adds all terms of fine direction O: first all threads read its blocks to
 * shared memory, then each thread uses them. */
template <int EDGES, int O>
static __device__ inline bool add_direction(struct sums *c, struct tile *t,
                                            const struct coarsen *s,
                                            struct place corner)
{
    read_tile(t, s, corner, s->block + O * s->count, s->n_live ? s->live : NULL,
              O);
    __syncthreads();
    add_edges<EDGES, O>(c, t, std::make_integer_sequence<int, AROUND>{});
    __syncthreads();
    return true;
}

template <int EDGES, int... O>
static __device__ inline void
add_all(struct sums *c, struct tile *t, const struct coarsen *s,
        struct place corner, std::integer_sequence<int, O...>)
{
    const bool each[] = {add_direction<EDGES, O>(c, t, s, corner)...};
    (void)each;
}

/* Returns the contribution of the fine excess to a coarse direction, as `share`
 * of gpu/solve/galerkin.cuh does. */
static __device__ inline sym shared_of(const struct tile *t, int i, int j,
                                       int ci, int cj)
{
    sym sum = {0, 0, 0, 0, 0, 0};
    UNROLL
    for (int k = 0; k < 9; k++) {
        int di = k % 3 - 1, dj = k / 3 - 1, a = hat(di, dj);
        int w = ci == 0 && cj == 0 ? 4 * a : -a * hat(di - 2 * ci, dj - 2 * cj);
        if (w != 0)
            sum = plus(sum, (real)w * R(0.0625), at_tile(t, i, j, di, dj));
    }
    return sum;
}

static __device__ inline void add_shares(struct sums *c, const struct tile *t)
{
    UNROLL
    for (int o = 0; o < STENCIL; o++) {
        int ci = toward_i<STENCIL>(o), cj = toward_j<STENCIL>(o);
        if (ci >= -1 && ci <= 1 && cj <= 1)
            c->sum[o] = add(c->sum[o], shared_of(t, c->i, c->j, ci, cj));
    }
    c->excess = shared_of(t, c->i, c->j, 0, 0);
}

/* A thread block owns a tile, and a thread owns a coarse particle: it writes
 * all blocks and the excess of its particle, unless a rule matters to the
 * particle (then coarsen_cut_kernel does it). */
template <int EDGES>
KERNEL coarsen_tile_kernel(const struct coarsen &s, const struct grid &g)
{
    __shared__ struct tile t;
    struct sums c = {};
    int tiles = (g.m + TILE_I - 1) / TILE_I, k = (int)blockIdx.x;
    struct place corner = {0, k % tiles * TILE_I, k / tiles * TILE_J};
    c.i = (int)threadIdx.x % TILE_I;
    c.j = (int)threadIdx.x / TILE_I;
    c.at = place{0, corner.i + c.i, corner.j + c.j};
    add_all<EDGES>(&c, &t, &s, corner,
                   std::make_integer_sequence<int, EDGES>{});
    read_tile(&t, &s, corner, s.excess, NULL, 0);
    __syncthreads();
    c.at.p = c.at.i + g.m * c.at.j;
    if (!within(g, c.at.i, c.at.j) || s.coarse_rule[c.at.p])
        return;
    add_shares(&c, &t);
    UNROLL
    for (int o = 0; o < STENCIL; o++)
        s.coarse_block[o * s.n_coarse + c.at.p] = c.sum[o];
    s.coarse_excess[c.at.p] = c.excess;
}

static inline int64_t tiles_of(struct grid g)
{
    int64_t wide = (g.m + TILE_I - 1) / TILE_I;
    return wide * ((g.n + TILE_J - 1) / TILE_J);
}

#endif
