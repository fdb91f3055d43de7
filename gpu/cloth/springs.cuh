/* SPDX-License-Identifier: Apache-2.0 */
/* The force on each particle, handed to a functor: the stream of forces or the
 * updates of an explicit method. spec/cloth/springs.md */
#ifndef GPU_SPRINGS_CUH
#define GPU_SPRINGS_CUH

#include "gpu/cloth/cloth.cuh"

extern "C" {
#include "ref/cloth/springs.h"
}

/* A block owns a tile of TILE_WIDE × HIGH particles. Springs reach TILE_HALO
 * particles further. */
enum { TILE_WIDE = 32, TILE_HALO = 2, TILE_ACROSS = TILE_WIDE + 2 * TILE_HALO };

/* The springs of direction o that pull at a tile's particles start in the tile
 * or one step before it. tile_left: the first column in which they start, seen
 * from the tile's first column; tile_wide: how many start in a row. */
static __host__ __device__ constexpr int tile_left(int o)
{
    return forward_i(o) > 0 ? -forward_i(o) : 0;
}
static __host__ __device__ constexpr int tile_wide(int o)
{
    return TILE_WIDE + (forward_i(o) < 0 ? -forward_i(o) : forward_i(o));
}

/* before[o]: the number of such springs in the directions before o, for a tile
 * of `high` rows. */
struct tile_pulls {
    int before[SPRINGS + 1];
    __host__ __device__ constexpr tile_pulls(int high) : before{}
    {
        for (int o = 0; o < SPRINGS; o++)
            before[o + 1] = before[o] + tile_wide(o) * (high + forward_j(o));
    }
};

/* A direction in a tile: its first pull, the springs in a row, 65536 / wide + 1
 * for divisions by wide, and the place of its first spring. */
struct alignas(16) tile_way {
    int pull, wide, over, place;
};

/* Shared memory of a block: the particles of the tile and its halo, row by row,
 * and the pull of each spring on the particle that the spring starts at. MOVED:
 * 1: the particles are at x + span·u, §6. */
template <int HIGH, int MOVED> struct tile {
    enum { PLACES = TILE_ACROSS * (HIGH + 2 * TILE_HALO) };
    enum { PULLS = tile_pulls(HIGH).before[SPRINGS], MOVES = MOVED };
    struct tile_way way[SPRINGS];
    struct law law[SPRINGS];
    const struct piece *piece;
    vec x[PLACES], v[PLACES], pull[PULLS], u[MOVED ? PLACES : 1];
    real span;
    real triple[TRIPLES];
    uint8_t springs[PLACES], beside[PLACES]; /* 0 outside the grid */
};

template <int HIGH, int MOVED>
static __device__ void tile_lead(const struct springs *s,
                                 struct tile<HIGH, MOVED> *a, int o)
{
    constexpr struct tile_pulls pulls(HIGH);
    struct tile_way w = {};
    UNROLL
    for (int d = 0; d < SPRINGS; d++)
        if (d == o)
            w = {pulls.before[d], tile_wide(d), 65536 / tile_wide(d) + 1,
                 (TILE_HALO - forward_j(d)) * TILE_ACROSS + TILE_HALO +
                     tile_left(d)};
    a->way[o] = w;
    a->law[o] = s->law[o];
}

/* Loads place k of the tile whose first particle is (i0, j0). */
template <class TILE>
static __device__ void tile_fill(const struct springs *s, TILE *a, int i0,
                                 int j0, int k)
{
    int j = k / TILE_ACROSS, i = i0 - TILE_HALO + (k - j * TILE_ACROSS);
    j += j0 - TILE_HALO;
    a->springs[k] = a->beside[k] = 0;
    if (i < 0 || j < 0 || i >= s->m || j >= s->n)
        return;
    int p = i + j * s->m;
    a->springs[k] = s->springs[p];
    if (s->triples)
        a->beside[k] = s->beside[p];
    a->x[k] = s->x[p];
    if (TILE::MOVES)
        a->u[k] = s->u[p];
    if (s->n_v)
        a->v[k] = s->v[p];
}

/* From place p to place q, §6. */
template <class TILE>
static __device__ vec tile_way_of(const TILE *a, int p, int q)
{
    vec d = sub(a->x[q], a->x[p]);
    return TILE::MOVES ? axpy(d, a->span, sub(a->u[q], a->u[p])) : d;
}

/* §1: the pull on place p of a spring to place q. */
template <class TILE>
static __device__ vec tile_pull(const TILE *a, const struct law *law,
                                bool damped, real fraction, int p, int q)
{
    vec d = tile_way_of(a, p, q);
    real l = length(d);
    if (!(l > 0))
        return make(0, 0, 0);
    vec u = scale(1 / l, d);
    real f = spring_tension(law, a->piece, l);
    if (damped)
        f += law->damp * dot(sub(a->v[q], a->v[p]), u);
    return scale(fraction * f, u);
}

/* §5: the constant times the second difference of the triple of direction o, of
 * a single spring, that starts at place p. */
template <class TILE>
static __device__ vec tile_triple(const TILE *a, int o, int p)
{
    int step = forward_i(o) + forward_j(o) * TILE_ACROSS, at = p + step;
    real k = a->triple[CELL_MASKS * o + a->beside[at]];
    if (!(k > 0))
        return make(0, 0, 0);
    vec t = triple_at(a->x[p], a->x[at], a->x[at + step]);
    if (TILE::MOVES)
        t = axpy(t, a->span, triple_at(a->u[p], a->u[at], a->u[at + step]));
    return scale(k, t);
}

/* Computes pull k of the tile, counted over all directions. With triples the
 * pulls of double springs are what tile_triple returns. */
template <int HIGH, int MOVED>
static __device__ vec tile_pull_of(const struct tile<HIGH, MOVED> *a,
                                   bool damped, bool triples, int k)
{
    constexpr struct tile_pulls pulls(HIGH);
    int o = 0;
    UNROLL
    for (int d = 1; d < SPRINGS; d++)
        o += k >= pulls.before[d];
    struct tile_way w = a->way[o];
    int n = k - w.pull, row = n * w.over >> 16; /* n / wide, as n < 1024 */
    int p = w.place + row * TILE_ACROSS + (n - row * w.wide);
    if (triples && o >= SPRINGS_SINGLE)
        return tile_triple(a, o - SPRINGS_SINGLE, p);
    if (!(a->springs[p] >> o & 1))
        return make(0, 0, 0);
    int q = p + forward_i(o) + forward_j(o) * TILE_ACROSS;
    real fraction = triples ? spring_fraction(o, a->beside[p]) : R(1);
    return tile_pull(a, &a->law[o], damped, fraction, p, q);
}

/* §2: the sum of the pulls on particle (i, j) of the tile, for each direction
 * the forward, then the backward spring. A spring's pull on its far end is the
 * exact negative of the pull on its start (§4). The sign of a zero may differ,
 * but no sum that starts from +0 shows this; hence a missing spring may also
 * add +0. */
template <int HIGH, int MOVED>
static __device__ vec tile_force(const struct tile<HIGH, MOVED> *a,
                                 bool triples, int i, int j)
{
    constexpr struct tile_pulls pulls(HIGH);
    vec f = make(0, 0, 0);
    UNROLL
    for (int o = 0; o < SPRINGS; o++) {
        int wide = tile_wide(o);
        const vec *row = a->pull + pulls.before[o] + j * wide;
        int here = forward_j(o) * wide + i - tile_left(o);
        vec from = row[here], to = row[i - forward_i(o) - tile_left(o)];
        if (triples && o >= SPRINGS_SINGLE) {
            vec at = row[here - forward_j(o) / 2 * wide - forward_i(o) / 2];
            f = add(f, sub(scale(2, at), add(from, to)));
        } else
            f = sub(add(f, from), to);
    }
    return f;
}

/* Thread t of a block owns particle (t % TILE_WIDE, t / TILE_WIDE) of the tile,
 * if the tile has that particle, and hands its force to `to`. All threads
 * compute pulls. `to` must not write x, v or u, which other blocks still read.
 */
template <int HIGH, int MOVED, int THREADS, class To>
KERNEL springs_kernel(const struct springs &s, int across, const To &to)
{
    typedef struct tile<HIGH, MOVED> part;
    __shared__ part a;
    int t = (int)threadIdx.x, block = (int)blockIdx.x;
    int row = block / across, i0 = (block - row * across) * TILE_WIDE;
    int j0 = row * HIGH, i = t % TILE_WIDE, j = t / TILE_WIDE;
    if (t < SPRINGS)
        tile_lead(&s, &a, t);
    if (t == 0) {
        a.piece = s.piece;
        a.span = s.span;
    }
    if (s.triples && t < TRIPLES)
        a.triple[t] = s.triple[t];
    for (int k = t; k < part::PLACES; k += THREADS)
        tile_fill(&s, &a, i0, j0, k);
    __syncthreads();
    for (int k = t; k < part::PULLS; k += THREADS)
        a.pull[k] = tile_pull_of(&a, s.n_v > 0, s.triples > 0, k);
    __syncthreads();
    if (j >= HIGH || i0 + i >= s.m || j0 + j >= s.n)
        return;
    int p = i0 + i + (j0 + j) * s.m;
    vec f = tile_force(&a, s.triples > 0, i, j);
    if (s.n_wind)
        f = add(f, s.wind[p]);
    to.take(p, axpy(f, s.mass[p], s.gravity));
}

template <int HIGH, int MOVED, int THREADS, class To>
static void springs_in(struct gpu *g, const struct springs *s, To to)
{
    int across = s->m / TILE_WIDE + (s->m % TILE_WIDE > 0);
    int64_t down = s->n / HIGH + (s->n % HIGH > 0);
    LAUNCH_BLOCKS(g, down * across, THREADS,
                  (springs_kernel<HIGH, MOVED, THREADS, To>), *s, across, to);
}

/* Calls to.take(p, force) for each particle p. MOVED: 1 if s->n_u is not 0.
 * Small grids get small tiles, since they have few blocks; in binary64 shared
 * memory limits the tile. */
template <int MOVED, class To>
static void springs_to(struct gpu *g, const struct springs *s, To to)
{
#if REAL_BITS == 32
    if (s->count <= 1 << 16)
        springs_in<4, MOVED, 512>(g, s, to);
    else
        springs_in<8, MOVED, 512>(g, s, to);
#else
    constexpr int high = MOVED ? 2 : 4;
    if (s->count <= 1 << 16)
        springs_in<high, MOVED, 512>(g, s, to);
    else
        springs_in<high, MOVED, 256>(g, s, to);
#endif
}

#endif
