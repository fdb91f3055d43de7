/* SPDX-License-Identifier: Apache-2.0 */
/* The force on each particle. spec/04_springs.md */
#include "gpu/cloth.cuh"

/* A block owns WIDE × HIGH particles; springs reach RIM of them further. */
enum {
    WIDE = 32,
    HIGH = 8,
    THREADS = WIDE * HIGH,
    RIM = 2,
    ACROSS = WIDE + 2 * RIM,
    PLACES = ACROSS * (HIGH + 2 * RIM)
};

/* What the threads of a block share: particles with their rim, row by row,
 * and the pulls of a direction's springs on the particle they start at. Two
 * directions take turns, so that one barrier each is enough. */
struct tile {
    vec x[PLACES], v[PLACES], pull[2][PLACES];
    uint8_t springs[PLACES]; /* 0 outside the grid */
};

/* Place k of the tile whose particle 0 is (i0, j0). */
static __device__ void fill(const struct springs *s, struct tile *a, int i0,
                            int j0, int k)
{
    int j = k / ACROSS, i = i0 - RIM + (k - j * ACROSS);
    j += j0 - RIM;
    a->springs[k] = 0;
    if (i < 0 || j < 0 || i >= s->m || j >= s->n)
        return;
    int p = i + j * s->m;
    a->springs[k] = s->springs[p];
    a->x[k] = s->x[p];
    if (s->n_v)
        a->v[k] = s->v[p];
}

/* §1: the pull on place p of a spring to place q. */
static __device__ vec pull(const struct tile *a, const struct law *law,
                           bool damped, int p, int q)
{
    vec d = sub(a->x[q], a->x[p]);
    real l = length(d);
    if (!(l > 0))
        return make(0, 0, 0);
    vec u = scale(1 / l, d);
    real f = spring_tension(law, l);
    if (damped)
        f += law->damp * dot(sub(a->v[q], a->v[p]), u);
    return scale(f, u);
}

/* The pulls of direction o that the tile's particles feel: of springs that
 * start in the tile, or one step before it. */
static __device__ void pulls(const struct springs *s, struct tile *a, int o)
{
    struct law law = s->law[o];
    int di = forward_i(o), dj = forward_j(o);
    int left = di > 0 ? di : 0, wide = WIDE + (di < 0 ? -di : di);
    int first = (RIM - dj) * ACROSS + RIM - left;
    int over = 65536 / wide + 1; /* k · over / 2^16 is k / wide: k < 1024 */
    for (int k = (int)threadIdx.x; k < wide * (HIGH + dj); k += THREADS) {
        int row = k * over >> 16, p = first + row * ACROSS + (k - row * wide);
        bool is = a->springs[p] >> o & 1;
        a->pull[o % 2][p] =
            is ? pull(a, &law, s->n_v > 0, p, p + di + dj * ACROSS)
               : make(0, 0, 0);
    }
}

/* Thread t of a block owns particle (t % WIDE, t / WIDE) of it and writes its
 * force; all take part in the pulls. §2: forward and backward spring of each
 * direction in turn. A spring's pull on its far end is exactly the negative
 * of that on its start (§4), up to the sign of a zero, which no sum that
 * starts from +0 shows; for the same reason springs that are not there may
 * add +0. */
static __global__ void __launch_bounds__(THREADS)
    springs_kernel(struct springs s, int across)
{
    __shared__ struct tile a;
    int t = (int)threadIdx.x, block = (int)blockIdx.x;
    int row = block / across, i0 = (block - row * across) * WIDE;
    int j0 = row * HIGH, i = i0 + t % WIDE, j = j0 + t / WIDE;
    int here = (t / WIDE + RIM) * ACROSS + t % WIDE + RIM;
    for (int k = t; k < PLACES; k += THREADS)
        fill(&s, &a, i0, j0, k);
    __syncthreads();
    vec f = make(0, 0, 0);
    for (int o = 0; o < SPRINGS; o++) {
        pulls(&s, &a, o);
        __syncthreads();
        int step = forward_i(o) + forward_j(o) * ACROSS;
        f = add(f, a.pull[o % 2][here]);
        f = sub(f, a.pull[o % 2][here - step]);
    }
    if (i >= s.m || j >= s.n)
        return;
    int p = i + j * s.m;
    if (s.n_wind)
        f = add(f, s.wind[p]);
    s.force[p] = axpy(f, s.mass[p], s.gravity);
}

int gpu_springs(struct gpu *g, struct springs *s)
{
    int across = s->m / WIDE + (s->m % WIDE > 0);
    int64_t down = s->n / HIGH + (s->n % HIGH > 0);
    LAUNCH_BLOCKS(g, down * across, THREADS, springs_kernel, *s, across);
    return gpu_status(g);
}
