/* SPDX-License-Identifier: Apache-2.0 */
/* Stages excess and coarsen on the device: the part of the finest grid's
 * operator that couples no two free particles; and a coarse grid's operator
 * from the next finer grid's, by Galerkin coarsening with bilinear
 * interpolation. spec/solve/multigrid.md §1, §2 */
#include "gpu/run/merge.cuh"
#include "gpu/solve/galerkin.cuh"
#include "gpu/solve/level.cuh"
#include "gpu/solve/tile.cuh"

/* With at least this many coarse particles, tiles (gpu/solve/tile.cuh) are
 * faster than a thread for each item. */
#ifdef __CUDACC__
enum { TILES_LEAST = 1 << 15 };
#else
enum { TILES_LEAST = 64 };
#endif

/* Thread p owns particle p and writes excess[p], live[p] and rule[p]. */
KERNEL excess_kernel(const struct excess &s)
{
    ITEM(item, s.count);
    struct grid g = {s.m, s.n};
    struct place at = place_of(g, item);
    bool here = s.fixed[at.p];
    real mass = s.mass[at.p];
    sym e = {mass, 0, 0, mass, 0, mass};
    int live = 0;
    if (s.n_extra)
        e = add(e, s.extra[at.p]);
    for (int o = 0; o < SPRINGS; o++) {
        const sym *block = s.block + o * s.count;
        int di = forward_i(o), dj = forward_j(o), step = di + s.m * dj;
        if (within(g, at.i + di, at.j + dj)) {
            if (s.fixed[at.p + step])
                e = add(e, fetch(block + at.p));
            else if (!here)
                live |= 1 << o;
        }
        if (within(g, at.i - di, at.j - dj) && s.fixed[at.p - step])
            e = add(e, fetch(block + (at.p - step)));
    }
    s.excess[at.p] = here ? sym{0, 0, 0, 0, 0, 0} : e;
    s.live[at.p] = (uint8_t)live;
    s.rule[at.p] = rule_at(g, at, s.block, s.block + s.count);
}

int gpu_excess(struct gpu *g, struct excess *s)
{
    if (s->m < 1 || s->n < 1 || s->count != (int64_t)s->m * s->n ||
        s->n_blocks != SPRINGS * s->count ||
        (s->n_extra && s->n_extra != s->count))
        return DRAPE_EARG;
    MERGE(g, s->count, (*s), excess_kernel);
    return gpu_status(g);
}

/* Thread p owns coarse particle p and writes coarse_rule[p]: whether a rule of
 * a fine particle matters to p. */
KERNEL coarsen_find_kernel(const struct coarsen &s, const struct grid &c)
{
    ITEM(item, s.n_coarse);
    find(&s, place_of(c, item));
}

/* Each thread owns an item: a coarse block, or the excess of a coarse particle.
 */
KERNEL coarsen_kernel(const struct coarsen &s, const struct grid &c,
                      const struct book &book)
{
    ITEM(item, (STENCIL + 1) * s.n_coarse);
    make_item<8>(&s, c, &book, item);
}

/* Makes the items that the kernel of tiles leaves out. A thread block owns
 * GPU_BLOCK coarse particles; its threads take turns at the items of those
 * particles to which a rule matters. */
KERNEL coarsen_cut_kernel(const struct coarsen &s, const struct grid &c,
                          const struct book &book)
{
    __shared__ int32_t cut[GPU_BLOCK], n;
    int t = (int)threadIdx.x;
    int64_t p = (int64_t)blockIdx.x * GPU_BLOCK + t;
    if (t == 0)
        n = 0;
    __syncthreads();
    if (p < s.n_coarse && s.coarse_rule[p])
        cut[atomicAdd(&n, 1)] = (int32_t)p;
    __syncthreads();
    for (int k = t; k < (STENCIL + 1) * n; k += GPU_BLOCK)
        make_item<8>(&s, c, &book, k / n * s.n_coarse + cut[k % n]);
}

/* Thread p owns coarse particle p: it writes factor[p] and coarse_rule[p], and
 * reads the coarse blocks and the excess, which must be complete. */
KERNEL coarsen_factor_kernel(const struct coarsen &s, const struct grid &c)
{
    ITEM(item, s.n_coarse);
    struct place at = place_of(c, item);
    make_factor(&s, c, at);
    make_rule(&s, c, at);
}

static void coarsen_by_tiles(struct gpu *g, const struct coarsen *s,
                             struct grid c, const struct book *book)
{
    if (s->n_live > 0)
        MERGE_BLOCKS(g, tiles_of(c), TILE_BLOCK, TILE_BLOCK, 2, (*s, c),
                     coarsen_tile_kernel<SPRINGS>);
    else
        MERGE_BLOCKS(g, tiles_of(c), TILE_BLOCK, TILE_BLOCK, 2, (*s, c),
                     coarsen_tile_kernel<STENCIL>);
    MERGE_BLOCKS(g, (s->n_coarse + GPU_BLOCK - 1) / GPU_BLOCK, GPU_BLOCK,
                 GPU_BLOCK, 1, (*s, c, *book), coarsen_cut_kernel);
}

int gpu_coarsen(struct gpu *g, struct coarsen *s)
{
    struct grid c = {s->m / 2 + 1, s->n / 2 + 1};
    bool springs = s->n_live > 0;
    if (s->m < 1 || s->n < 1 || s->count != (int64_t)s->m * s->n ||
        s->n_blocks != (springs ? (int)SPRINGS : (int)STENCIL) * s->count ||
        (springs && s->n_live != s->count) ||
        s->n_coarse != (int64_t)c.m * c.n || s->n_out != STENCIL * s->n_coarse)
        return DRAPE_EARG;
    const struct book *book = springs ? book_of<SPRINGS>() : book_of<STENCIL>();
    MERGE(g, s->n_coarse, (*s, c), coarsen_find_kernel);
    if (s->n_coarse >= TILES_LEAST)
        coarsen_by_tiles(g, s, c, book);
    else
        MERGE(g, (STENCIL + 1) * s->n_coarse, (*s, c, *book), coarsen_kernel);
    MERGE(g, s->n_coarse, (*s, c), coarsen_factor_kernel);
    return gpu_status(g);
}

/* The grids of a chain. The operator of the first one must have been made.
 * CHAIN_GRIDS: the most of them: the second has at most CHAIN_COUNT < 2^11
 * particles, each later one not much more than half as many (1200 by 1, 601 by
 * 1, …), and the last at most COARSEST. */
enum { CHAIN_GRIDS = 16 };
struct chain {
    int grids;
    struct small {
        struct grid g;
        sym *excess; /* followed in memory by the factors and the blocks */
        uint8_t *rule;
    } grid[CHAIN_GRIDS];
};

/* Returns the arguments of the coarsening from grid k - 1 to grid k. */
static __device__ struct coarsen link_of(const struct chain *s, int k)
{
    const struct chain::small *f = &s->grid[k - 1], *to = &s->grid[k];
    struct coarsen c = {};
    c.m = f->g.m;
    c.n = f->g.n;
    c.count = (int64_t)c.m * c.n;
    c.excess = f->excess;
    c.block = f->excess + 2 * c.count;
    c.rule = f->rule;
    c.n_coarse = (int64_t)to->g.m * to->g.n;
    c.coarse_excess = to->excess;
    c.factor = to->excess + c.n_coarse;
    c.coarse_block = c.factor + c.n_coarse;
    c.coarse_rule = to->rule;
    return c;
}

/* Sets the mark of each coarse particle to which the rule of the fine particle
 * at `at` matters: the result is that of `find`. */
static __device__ void mark(const struct chain::small *c, struct place at)
{
    for (int j = max_of((at.j - 4) / 2, 0); j <= (at.j + 3) / 2; j++)
        for (int i = max_of((at.i - 4) / 2, 0); i <= (at.i + 5) / 2; i++)
            if (within(c->g, i, j))
                c->rule[i + c->g.m * j] = 1;
}

/* Run by one cluster. For each grid k, its threads take turns at the items of
 * grid k and at the factors of grid k - 1, and clear the marks of grid k + 1.
 * After a barrier they take turns at the rules of grid k; each rule sets marks
 * of grid k + 1. */
KERNEL coarsen_chain_kernel(const struct chain &s, const struct book &book)
{
    struct coarsen c = link_of(&s, 1);
    EACH_OF_GROUP(e, c.n_coarse)
    find(&c, place_of(s.grid[1].g, e));
    for (int k = 1; k <= s.grids; k++) {
        struct coarsen before = c;
        int done = k > 1 ? (int)before.n_coarse : 0;
        bool more = k < s.grids;
        if (more)
            c = link_of(&s, k);
        struct grid g = s.grid[k - !more].g;
        int items = more ? (STENCIL + 1) * (int)c.n_coarse : 0;
        cluster_sync(false);
        EACH_OF_GROUP(e, items + done)
        if (e < items)
            make_item<16>(&c, g, &book, e);
        else
            make_factor(&before, s.grid[k - 1].g,
                        place_of(s.grid[k - 1].g, e - items));
        if (!more)
            break;
        const struct chain::small *after =
            k + 1 < s.grids ? &s.grid[k + 1] : NULL;
        EACH_OF_GROUP(e, after ? after->g.m * after->g.n : 0)
        after->rule[e] = 0;
        cluster_sync(false);
        EACH_OF_GROUP(e, c.n_coarse)
        {
            struct place at = place_of(g, e);
            if (make_rule(&c, g, at) && after)
                mark(after, at);
        }
    }
}

void gpu_coarsen_chain(struct gpu *g, const struct level *l, int levels)
{
    struct chain s = {};
    s.grids = levels;
    for (int k = 0; k < levels; k++)
        s.grid[k] = chain::small{l[k].g, l[k].excess, l[k].rule};
    int64_t items = levels > 1 ? (STENCIL + 1) * (int64_t)l[1].count : 0;
    MERGE_RANKS(g, ranks_for(items, CHAIN_BLOCK, g->ranks), CHAIN_BLOCK, 0,
                (s, *book_of<STENCIL>()), coarsen_chain_kernel);
}
