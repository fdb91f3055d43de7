/* SPDX-License-Identifier: Apache-2.0 */
/* One V-cycle over all cloths that seams join: on all grids but the finest one
 * kernel works for all cloths. spec/solve/sewn.md */
#include "gpu/solve/smooth.cuh"
#include "gpu/solve/sweep.cuh"

extern "C" {
#include "gpu/solve/sewn.h"
#include "ref/solve/sewn.h"
}

/* A cloth's grid in the cycle: grid k of cloth c is number k · cloths + c. */
struct sewn_cloth {
    struct level l;
    real damping;
    real *item;    /* of the finest grid: as in struct smoothing; else NULL */
    int32_t awake; /* 0: of this cloth nothing else is set */
};

/* THREADS: of a block that owns a group. */
#ifdef __CUDACC__
enum { THREADS = 512 };
#else
enum { THREADS = 64 };
#endif

static __device__ inline const struct sewn_cloth *grid_of(const struct sewn *s,
                                                          int k, int cloth)
{
    return &s->cloth[(int64_t)k * s->cloths + cloth];
}

/* §3.2: the diagonal block whose factors are f. */
static __device__ struct wide_sym unfactored(sym f)
{
    double x = 1 / (double)f.xx, y = 1 / (double)f.yy, z = 1 / (double)f.zz;
    double xy = (double)f.xy * x, xz = (double)f.xz * x;
    double yz = (double)f.yz * y;
    return wide_sym{{x, xy, xz, y + (double)f.xy * xy, yz + (double)f.xy * xz,
                     z + ((double)f.xz * xz + (double)f.yz * yz)}};
}

/* A row of so many links at once: a warp owns a row, and each lane a link. */
enum { ROWS = GPU_BLOCK / WARP };

static __device__ inline int row_at(void)
{
    return (int)blockIdx.x * ROWS + (int)threadIdx.x / WARP;
}

static int row_blocks(int64_t rows)
{
    return (int)((rows + ROWS - 1) / ROWS);
}

/* A warp owns a row of all grids but the last, and its factor. */
KERNEL sewn_ground_kernel(const struct sewn &s)
{
    int i = row_at(), lane = (int)threadIdx.x % WARP, k = 0;
    if (i >= s.row_at[s.depth])
        return;
    const struct sewn_row *row = &s.row[i];
    while (i >= s.row_at[k + 1])
        k++;
    const struct sewn_cloth *c = grid_of(&s, k, row->cloth);
    if (!c->awake)
        return;
    sym *to = (sym *)c->l.factor + row->particle, f = *to;
    if (f.xx == 0)
        return; /* what is fixed has no factor */
    struct wide_sym d = unfactored(f);
    real by = R(0.5625) * c->damping; /* 1/h */
    for (int32_t first = row->first; first < row->end; first += WARP) {
        int32_t e = first + lane, n = min_of(row->end - first, (int32_t)WARP);
        sym part = {0, 0, 0, 0, 0, 0};
        if (lane < n) {
            const struct sewn_link *link = &s.link[s.of_row[e].at];
            sym q = s.kappa[link->source];
            real all = 0;
            for (int32_t j = link->first; j < link->end; j++)
                all += magnitude(s.of_link[j].c);
            real t = by * (link->times * all * magnitude(s.of_row[e].c));
            part =
                sym{t * q.xx, t * q.xy, t * q.xz, t * q.yy, t * q.yz, t * q.zz};
        }
        for (int l = 0; l < n; l++)
            d = add(d, sym{lane_value(part.xx, l), lane_value(part.xy, l),
                           lane_value(part.xz, l), lane_value(part.yy, l),
                           lane_value(part.yz, l), lane_value(part.zz, l)});
    }
    if (lane == 0)
        *to = factored(d);
}

/* §2: what a link of grid k answers to y. */
static __device__ vec link_answer(const struct sewn *s, int k,
                                  const struct sewn_link *link)
{
    vec sum = make(0, 0, 0);
    UNROLL_8
    for (int32_t j = link->first; j < link->end; j++) {
        const struct sewn_row *r = &s->row[s->of_link[j].at];
        sum = axpy(sum, s->of_link[j].c,
                   grid_of(s, k, r->cloth)->l.y[r->particle]);
    }
    return apply(s->kappa[link->source], sum);
}

/* §2: what the links of a row of grid k answer to y: all lanes have it. */
static __device__ vec row_answer(const struct sewn *s, int k,
                                 const struct sewn_row *row)
{
    vec all = make(0, 0, 0);
    int lane = (int)threadIdx.x % WARP;
    for (int32_t first = row->first; first < row->end; first += WARP) {
        int32_t e = first + lane, n = min_of(row->end - first, (int32_t)WARP);
        vec part = make(0, 0, 0);
        if (lane < n) {
            const struct sewn_link *link = &s->link[s->of_row[e].at];
            part = scale(link->times * s->of_row[e].c, link_answer(s, k, link));
        }
        for (int l = 0; l < n; l++)
            all = add(all, lane_value(part, l));
    }
    return all;
}

/* A warp owns a row of grid k: on the way down the residual of its particle, in
 * x, gains what its links push; on the way up, what is smoothed, in x. */
template <bool UP>
KERNEL sewn_answer_kernel(const struct sewn &s, int k, const int32_t *go)
{
    int64_t i = s.row_at[k] + row_at();
    if (idle(go) || i >= s.row_at[k + 1])
        return;
    const struct sewn_row *row = &s.row[i];
    const struct sewn_cloth *c = grid_of(&s, k, row->cloth);
    int32_t p = row->particle;
    if (!c->awake || (!UP && c->l.fixed && c->l.fixed[p]))
        return;
    vec push = row_answer(&s, k, row), *x = &c->l.x[p];
    if (threadIdx.x % WARP)
        return;
    if (!UP) {
        *x = sub(*x, push);
        return;
    }
    *x = axpy(*x, -c->damping, solved(c->l.factor[p], push));
    if (c->item)
        c->item[p] = dot(c->l.b[p], *x);
}

/* Which cloth a block works for, and its number there, of `each` blocks. */
static __device__ inline const struct sewn_cloth *
cloth_of(const struct sewn *s, int k, int each, int *block)
{
    int cloth = (int)blockIdx.x / each;
    *block = (int)blockIdx.x % each;
    return cloth < s->cloths ? grid_of(s, k, cloth) : NULL;
}

/* The blocks of all grids number k, `each` a cloth: four adjacent lanes own a
 * particle, as in gather_kernel: its residual after y, or y smoothed, to x. */
template <bool UP>
KERNEL sewn_product_kernel(const struct sewn &s, int k, int each,
                           const int32_t *go)
{
    int block, lane = (int)threadIdx.x % GATHER_LANES;
    const struct sewn_cloth *c = cloth_of(&s, k, each, &block);
    if (idle(go) || !c || !c->awake || block * GATHERED >= c->l.count)
        return;
    int item = block * GATHERED + (int)threadIdx.x / GATHER_LANES;
    struct edges<sym> t = edges_of(&c->l);
    struct plain y = {c->l.y};
    struct place at = place_of(c->l.g, item < c->l.count ? item : 0);
    vec here, sum = gathered<STENCIL, GATHER_LANES>(&t, &y, at, lane, &here);
    if (item >= c->l.count || lane != GATHER_LANES - 1)
        return;
    if (UP) {
        struct smoothing end = smoothing_of(&c->l, c->damping);
        arrive(&end, at, about(&end, at), here, sum);
    } else {
        struct left end = left_of(&c->l);
        arrive(&end, at, about(&end, at), here, sum);
    }
}

/* Threads own the particles of all grids number k + 1: as
 * multigrid_restrict_kernel. */
KERNEL sewn_restrict_kernel(const struct sewn &s, int k, int each,
                            const int32_t *go)
{
    int block;
    const struct sewn_cloth *f = cloth_of(&s, k, each, &block);
    if (idle(go) || !f || !f->awake)
        return;
    const struct sewn_cloth *c = f + s.cloths;
    int item = block * GPU_BLOCK + (int)threadIdx.x;
    if (item < c->l.count)
        restrict_at(&f->l, &c->l, place_of(c->l.g, item), c->damping);
}

/* Threads own the particles of all grids number k: as multigrid_prolong_kernel.
 */
KERNEL sewn_prolong_kernel(const struct sewn &s, int k, int each,
                           const int32_t *go)
{
    int block;
    const struct sewn_cloth *f = cloth_of(&s, k, each, &block);
    if (idle(go) || !f || !f->awake)
        return;
    int item = block * GPU_BLOCK + (int)threadIdx.x;
    struct raised y = raised_from(&f[s.cloths].l, &f->l);
    if (item < f->l.count)
        f->l.y[item] = value_at(&y, place_of(f->l.g, item));
}

/* §4 */

/* Which cloth of group `of`, and which row of the last grid, an unknown is. */
struct unknown {
    int cloth, particle, axis;
    const struct sewn_row *row; /* NULL: no link holds it */
};

static __device__ struct unknown unknown_at(const struct sewn *s, int of, int i)
{
    struct unknown u = {-1, 0, 0, NULL};
    for (int c = 0; c < s->cloths; c++) {
        int at = i - s->place[c].first;
        const struct level *l = &grid_of(s, s->depth, c)->l;
        if (s->place[c].group == of && at >= 0 && at < 3 * l->count)
            u = unknown{c, at / 3, at % 3, NULL};
    }
    for (int64_t r = s->row_at[s->depth]; r < s->row_at[s->depth + 1]; r++)
        if (s->row[r].cloth == u.cloth && s->row[r].particle == u.particle)
            u.row = &s->row[r];
    return u;
}

/* What links couple of two unknowns, link by link, added to a. */
static __device__ double add_links(const struct sewn *s, struct unknown x,
                                   struct unknown y, double a)
{
    if (!x.row || !y.row)
        return a;
    for (int32_t e = x.row->first; e < x.row->end; e++) {
        const struct sewn_link *link = &s->link[s->of_row[e].at];
        for (int32_t j = link->first; j < link->end; j++) {
            if (&s->row[s->of_link[j].at] != y.row)
                continue;
            double c = (double)s->of_row[e].c * (double)s->of_link[j].c;
            a += (double)link->times * c *
                 component(s->kappa[link->source], x.axis, y.axis);
        }
    }
    return a;
}

/* Thread e owns an entry of the inverses: fills it with the matrix. */
KERNEL sewn_fill_kernel(const struct sewn &s)
{
    ITEM(e, s.n_dense);
    int of = 0;
    while (of + 1 < s.groups && e >= s.group[of + 1].dense)
        of++;
    const struct sewn_group *g = &s.group[of];
    if (!grid_of(&s, s.depth, g->cloth)->awake)
        return;
    int64_t at = e - g->dense;
    struct unknown x = unknown_at(&s, of, (int)(at / g->n));
    struct unknown y = unknown_at(&s, of, (int)(at % g->n));
    double a = 0;
    if (x.cloth == y.cloth) {
        const struct level *l = &grid_of(&s, s.depth, x.cloth)->l;
        struct coarsest c = {l->g.m,    l->g.n,   l->count,
                             l->excess, l->block, NULL};
        int i = 3 * x.particle + x.axis, j = 3 * y.particle + y.axis;
        a = coarsest_entry(&c, l->block, l->excess, i < j ? j : i,
                           i < j ? i : j);
    }
    s.dense[e] = add_links(&s, x, y, a);
}

/* Block k owns group k: inverts its matrix in place, by the lower triangle. */
KERNEL sewn_invert_kernel(const struct sewn &s)
{
    int t = (int)threadIdx.x;
    if ((int)blockIdx.x >= s.groups)
        return;
    const struct sewn_group *g = &s.group[blockIdx.x];
    int n = g->n;
    double *a = s.dense + g->dense, trace = 0;
    double *column = s.in + g->first, *inverse = s.out + g->first;
    if (!grid_of(&s, s.depth, g->cloth)->awake)
        return;
    for (int k = 0; k < n; k++)
        trace += a[(int64_t)k * n + k];
    for (int k = 0; k < n; k++) {
        double d = a[(int64_t)k * n + k];
        double by = d > 0x1p-40 * trace ? 1 / d : 0;
        for (int i = t; i < n; i += THREADS)
            column[i] = i < k ? a[(int64_t)k * n + i] : a[(int64_t)i * n + k];
        __syncthreads();
        if (t == 0)
            inverse[k] = by;
        for (int i = t / WARP; i < n && by != 0; i += THREADS / WARP) {
            double l = column[i] * by, *row = a + (int64_t)i * n;
            for (int j = t % WARP; j <= i; j += WARP) {
                double e = row[j] - l * column[j];
                e = j == k ? l : e;
                e = i == k ? column[j] * by : e;
                row[j] = i == k && j == k ? -by : e;
            }
        }
        __syncthreads();
    }
    for (int i = t / WARP; i < n; i += THREADS / WARP)
        for (int j = t % WARP; j <= i; j += WARP) {
            bool parked = inverse[i] == 0 || inverse[j] == 0;
            double e = parked ? 0 : -a[(int64_t)i * n + j];
            a[(int64_t)i * n + j] = a[(int64_t)j * n + i] = e;
        }
}

/* Block k owns group k: x of the last grids of its cloths from b. */
KERNEL sewn_solve_kernel(const struct sewn &s, const int32_t *go)
{
    int t = (int)threadIdx.x;
    if (idle(go) || (int)blockIdx.x >= s.groups)
        return;
    const struct sewn_group *g = &s.group[blockIdx.x];
    const double *a = s.dense + g->dense;
    double *in = s.in + g->first;
    if (!grid_of(&s, s.depth, g->cloth)->awake)
        return;
    for (int c = 0; c < s.cloths; c++) {
        const struct level *l = &grid_of(&s, s.depth, c)->l;
        const real *b = (const real *)l->b;
        if (s.place[c].group == (int)blockIdx.x)
            for (int i = t; i < 3 * l->count; i += THREADS)
                in[s.place[c].first + i] = (double)b[i];
    }
    __syncthreads();
    for (int c = 0; c < s.cloths; c++) {
        const struct level *l = &grid_of(&s, s.depth, c)->l;
        if (s.place[c].group != (int)blockIdx.x)
            continue;
        for (int i = t; i < 3 * l->count; i += THREADS) {
            const double *row = a + s.place[c].first + i; /* symmetric */
            double sum = 0;
            for (int j = 0; j < g->n; j++)
                sum += row[(int64_t)j * g->n] * in[j];
            ((real *)l->x)[i] = (real)sum;
        }
    }
}

static int64_t grids_of(const struct sewn *s)
{
    return (int64_t)(s->depth + 1) * s->cloths;
}

struct sewn *gpu_sewn_make(struct gpu *g, struct arena *host,
                           const struct sewn *from)
{
    struct sewn *s = (struct sewn *)arena_take(host, ARENA_OTHER, 1, sizeof *s);
    if (!s)
        return NULL;
    *s = *from;
    GPU_TAKE_COPY(g, s->link, ARENA_SOLVER, from->link, from->links);
    GPU_TAKE_COPY(g, s->row, ARENA_SOLVER, from->row, from->rows);
    GPU_TAKE_COPY(g, s->of_link, ARENA_SOLVER, from->of_link, from->terms);
    GPU_TAKE_COPY(g, s->of_row, ARENA_SOLVER, from->of_row, from->terms);
    GPU_TAKE_COPY(g, s->place, ARENA_SOLVER, from->place, from->cloths);
    GPU_TAKE_COPY(g, s->group, ARENA_SOLVER, from->group, from->groups);
    GPU_TAKE_COPY(g, s->kappa, ARENA_SOLVER, NULL, from->n);
    GPU_TAKE_COPY(g, s->dense, ARENA_SOLVER, NULL, from->n_dense);
    GPU_TAKE_COPY(g, s->in, ARENA_SOLVER, NULL, from->unknowns);
    GPU_TAKE_COPY(g, s->out, ARENA_SOLVER, NULL, from->unknowns);
    GPU_TAKE_COPY(g, s->cloth, ARENA_SOLVER, NULL, grids_of(from));
    s->listed = (struct sewn_cloth *)arena_take(
        host, ARENA_OTHER, grids_of(from), sizeof *s->listed);
    return s->listed ? s : NULL;
}

void gpu_sewn_clear(struct sewn *s)
{
    memset((void *)s->listed, 0, (size_t)grids_of(s) * sizeof *s->listed);
}

void gpu_sewn_put(struct sewn *s, int k, const struct multigrid *grid,
                  sym *lent, real *item)
{
    struct level l[LEVELS];
    int grids = gpu_multigrid_lay_out(grid, lent, NULL, l);
    for (int i = 0; i < grids; i++)
        s->listed[i * s->cloths + k] = sewn_cloth{
            l[i], i < s->depth ? gpu_multigrid_damping(grid, i) : R(0.0),
            i ? NULL : item, 1};
}

void gpu_sewn_send(struct gpu *g, struct sewn *s)
{
    gpu_up(g, s->cloth, s->listed, (size_t)grids_of(s) * sizeof *s->listed);
}

void gpu_sewn_set_up(struct gpu *g, const struct sewn *s)
{
    LAUNCH_PARTS(g, row_blocks(s->row_at[s->depth]), GPU_BLOCK, 1,
                 sewn_ground_kernel, *s);
    LAUNCH(g, s->n_dense, sewn_fill_kernel, *s);
    LAUNCH_PARTS(g, s->groups, THREADS, 1, sewn_invert_kernel, *s);
}

/* Blocks of so many particles for the largest grid number k. */
static int blocks_of(const struct sewn *s, int k, int size)
{
    int32_t most = 1;
    for (int c = 0; c < s->cloths; c++) {
        int32_t count = s->listed[k * s->cloths + c].l.count;
        most = count > most ? count : most;
    }
    return (most + size - 1) / size;
}

static int rows_of(const struct sewn *s, int k)
{
    return row_blocks(s->row_at[k + 1] - s->row_at[k]);
}

void gpu_sewn_cycle(struct gpu *g, const struct sewn *s, const int32_t *go)
{
    for (int k = 0; k < s->depth; k++) {
        int each = blocks_of(s, k, GATHERED);
        if (k > 0)
            LAUNCH_PARTS(g, each * s->cloths, GPU_BLOCK, 1,
                         sewn_product_kernel<false>, *s, k, each, go);
        LAUNCH_PARTS(g, rows_of(s, k), GPU_BLOCK, 1, sewn_answer_kernel<false>,
                     *s, k, go);
        each = blocks_of(s, k + 1, GPU_BLOCK);
        LAUNCH_PARTS(g, each * s->cloths, GPU_BLOCK, 1, sewn_restrict_kernel,
                     *s, k, each, go);
    }
    LAUNCH_PARTS(g, s->groups, THREADS, 1, sewn_solve_kernel, *s, go);
    for (int k = s->depth - 1; k >= 0; k--) {
        int each = blocks_of(s, k, GPU_BLOCK);
        LAUNCH_PARTS(g, each * s->cloths, GPU_BLOCK, 1, sewn_prolong_kernel, *s,
                     k, each, go);
        each = blocks_of(s, k, GATHERED);
        if (k == 0)
            break;
        LAUNCH_PARTS(g, each * s->cloths, GPU_BLOCK, 1,
                     sewn_product_kernel<true>, *s, k, each, go);
        LAUNCH_PARTS(g, rows_of(s, k), GPU_BLOCK, 1, sewn_answer_kernel<true>,
                     *s, k, go);
    }
}

void gpu_sewn_finish(struct gpu *g, const struct sewn *s, const int32_t *go)
{
    LAUNCH_PARTS(g, rows_of(s, 0), GPU_BLOCK, 1, sewn_answer_kernel<true>, *s,
                 0, go);
}
