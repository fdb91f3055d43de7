/* SPDX-License-Identifier: Apache-2.0 */
/* Stage multigrid on the device: one V-cycle of geometric multigrid.
 * spec/solve/multigrid.md */
#include "gpu/solve/smooth.cuh"
#include "gpu/solve/sweep.cuh"
#include "gpu/solve/tail.cuh"

/* §5: fills the list of grids, from fine to coarse, with the places of their
 * streams. */
int gpu_multigrid_lay_out(const struct multigrid *s, sym *lent,
                          const int32_t *go, struct level *l)
{
    sym *a = lent ? s->pool : s->pool + s->count;
    vec *v = s->room + s->count;
    struct level fine = {};
    fine.g = grid{s->m, s->n};
    fine.count = (int32_t)s->count;
    fine.mass = s->mass;
    fine.extra = s->n_extra ? s->extra : NULL;
    fine.fixed = s->fixed;
    fine.rule = s->live + s->count;
    fine.excess = lent ? lent : s->pool;
    fine.block = s->block;
    fine.packed = s->n_packed ? s->packed : NULL;
    fine.factor = s->factor;
    fine.b = (vec *)s->r; /* only read */
    fine.x = s->z;
    fine.y = s->room;
    fine.go = go;
    l[0] = fine;
    int levels = 1;
    while (s->depth ? levels <= s->depth
                    : levels == 1 || l[levels - 1].count > COARSEST) {
        const struct level *f = &l[levels - 1];
        struct level c = {};
        c.g = grid{f->g.m / 2 + 1, f->g.n / 2 + 1};
        c.count = c.g.m * c.g.n;
        c.rule = f->rule + f->count;
        c.excess = a;
        c.factor = a + c.count;
        c.block = a + 2 * (int64_t)c.count;
        c.x = v;
        c.b = v + c.count;
        c.y = v + 2 * (int64_t)c.count;
        c.go = go;
        a += (2 + STENCIL) * (int64_t)c.count;
        v += 3 * (int64_t)c.count;
        l[levels++] = c;
    }
    return levels;
}

/* §4: the damping where the eigenvalues of F A are at most `high`. */
static real damping_of(double high)
{
    return (real)(16 / (9 * high));
}

real gpu_multigrid_damping(const struct multigrid *s, int k)
{
    return k ? damping_of(s->n_extra ? 4 : 2.5)
             : damping_of(s->triples ? 2.7 : 2);
}

struct opening gpu_multigrid_opening(const struct multigrid *s)
{
    return opening{s->factor, s->room, gpu_multigrid_damping(s, 0)};
}

/* Thread p owns y[p]. */
KERNEL multigrid_first_kernel(const struct opening &o, int32_t count,
                              const vec *b)
{
    ITEM(p, count);
    open_at(&o, (int)p, b[p]);
}

/* Thread p owns particle p of the coarse grid and writes b[p] and y[p]. */
KERNEL multigrid_restrict_kernel(const struct level &f, const struct level &c,
                                 real damping)
{
    ITEM(item, c.count);
    if (!idle(c.go))
        restrict_at(&f, &c, place_of(c.g, item), damping);
}

/* Thread p owns particle p of the fine grid and updates y[p]. */
KERNEL multigrid_prolong_kernel(const struct level &f, const struct raised &s)
{
    ITEM(item, f.count);
    if (!idle(f.go))
        f.y[item] = value_at(&s, place_of(f.g, item));
}

template <class X, class END>
static void multiply(struct gpu *g, const struct level *l, X x, END end)
{
    edges<struct packed> packed = {l->g, l->mass, l->extra, NULL, l->packed};
    if (l->packed)
        product_of<SPRINGS>(g, packed, x, end, l->go);
    else if (l->mass)
        product_of<SPRINGS>(g, edges_of(l), x, end, l->go);
    else
        product_of<STENCIL>(g, edges_of(l), x, end, l->go);
}

void gpu_multigrid_descend(struct gpu *g, const struct level *l)
{
    multiply(g, l, plain{l->y}, left_of(l));
}

void gpu_multigrid_smooth(struct gpu *g, const struct level *l, real damping,
                          real *item)
{
    struct smoothing end = smoothing_of(l, damping);
    end.item = item;
    multiply(g, l, plain{l->y}, end);
}

/* Queues the way down on one grid: from b, smoothed in y, to the residual, and
 * then b of the next grid, unless the tail has it. */
static void go_down(struct gpu *g, const struct level *l, bool last,
                    real damping)
{
    const struct level *c = l + 1;
    gpu_multigrid_descend(g, l);
    if (!last)
        MERGE(g, c->count, (*l, *c, damping), multigrid_restrict_kernel);
}

/* Queues the way up on one grid. raised: y has the correction already. item: as
 * in struct smoothing. */
static void go_up(struct gpu *g, const struct level *l, bool raised,
                  real damping, real *item)
{
    struct raised y = raised_from(l + 1, l);
    struct smoothing end = smoothing_of(l, damping);
    end.item = item;
    if (!raised && sweeps(l->g)) {
        multiply(g, l, y, end);
        return;
    }
    if (!raised)
        MERGE(g, l->count, (*l, y), multigrid_prolong_kernel);
    gpu_multigrid_smooth(g, l, damping, item);
}

static struct coarsest coarsest_of(const struct multigrid *s,
                                   const struct level *l)
{
    struct coarsest c = {l->g.m,    l->g.n,   l->count,
                         l->excess, l->block, s->dense};
    return c;
}

void gpu_multigrid_cycle(struct gpu *g, struct multigrid *s, sym *lent,
                         const int32_t *go, real *item)
{
    struct level l[LEVELS];
    int levels = gpu_multigrid_lay_out(s, lent, go, l), first = 1, ranks = 1;
    real fine = gpu_multigrid_damping(s, 0);
    real coarse = gpu_multigrid_damping(s, 1);
    struct tail tail = {};
    int64_t room = fit_tail(&tail, l, levels, &first, &ranks, g);
    for (int k = 0; k < first; k++)
        go_down(g, &l[k], k + 1 == first, coarse);
    tail.coarsest = coarsest_of(s, &l[levels - 1]);
    tail.damping = coarse;
    tail.fine = l[first - 1];
    tail.raises = !sweeps(l[first - 1].g);
    tail.x = l[first].x;
    tail.go = go;
    MERGE_RANKS(g, ranks, TAIL_BLOCK, room, (tail), tail_kernel);
    for (int k = first - 1; k >= 0; k--)
        go_up(g, &l[k], tail.raises && k == first - 1, k ? coarse : fine,
              k ? NULL : item);
}

/* Makes grid k from the grid before. The finest grid has springs as its edges.
 */
static int coarsen(struct gpu *g, const struct multigrid *s,
                   const struct level *l, int k)
{
    const struct level *f = &l[k - 1], *to = &l[k];
    struct coarsen c = {};
    c.m = f->g.m;
    c.n = f->g.n;
    c.count = f->count;
    c.excess = f->excess;
    c.n_blocks = (k == 1 ? (int)SPRINGS : (int)STENCIL) * c.count;
    c.block = f->block;
    c.n_live = k == 1 ? c.count : 0;
    c.live = s->live;
    c.rule = f->rule;
    c.n_coarse = to->count;
    c.n_out = STENCIL * c.n_coarse;
    c.coarse_excess = to->excess;
    c.coarse_block = to->excess + 2 * c.n_coarse;
    c.factor = to->excess + c.n_coarse;
    c.coarse_rule = to->rule;
    return gpu_coarsen(g, &c);
}

int gpu_multigrid_build(struct gpu *g, struct multigrid *s, sym *lent)
{
    struct level l[LEVELS];
    struct excess e = {.m = s->m,
                       .n = s->n,
                       .count = s->count,
                       .mass = s->mass,
                       .n_extra = s->n_extra,
                       .extra = s->extra,
                       .n_blocks = s->n_blocks,
                       .block = s->block,
                       .fixed = s->fixed,
                       .excess = lent ? lent : s->pool,
                       .live = s->live,
                       .rule = s->live + s->count};
    int status = gpu_excess(g, &e), k = 1;
    int levels =
        status == DRAPE_OK ? gpu_multigrid_lay_out(s, lent, NULL, l) : 0;
    for (; k < levels && status == DRAPE_OK; k++) {
        if (k > 1 && l[k].count <= CHAIN_COUNT)
            break;
        status = coarsen(g, s, l, k);
    }
    if (status == DRAPE_OK) {
        struct coarsest d = coarsest_of(s, &l[levels - 1]);
        if (k < levels)
            gpu_coarsen_chain(g, &l[k - 1], levels - k + 1);
        gpu_coarsest_invert(g, &d);
    }
    return status;
}

int gpu_multigrid(struct gpu *g, struct multigrid *s)
{
    int status = gpu_multigrid_build(g, s, NULL);
    if (status == DRAPE_OK) {
        LAUNCH(g, s->count, multigrid_first_kernel, gpu_multigrid_opening(s),
               (int32_t)s->count, s->r);
        gpu_multigrid_cycle(g, s, NULL, NULL, NULL);
    }
    return status == DRAPE_OK ? gpu_status(g) : status;
}
