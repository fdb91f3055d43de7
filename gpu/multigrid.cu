/* SPDX-License-Identifier: Apache-2.0 */
/* Geometric multigrid V-cycle. spec/14_multigrid.md */
#include "gpu/coarsen.cuh"
#include "gpu/jacobi.cuh"
#include "gpu/level.cuh"
#include "gpu/march.cuh"

/* §5: the grids from fine to coarse and where their streams are. */
static int lay_out(const struct multigrid *s, const int32_t *go,
                   struct level *l)
{
    sym *a = s->pool + s->count;
    vec *v = s->room + 2 * s->count;
    struct level fine = {};
    fine.g = grid{s->m, s->n};
    fine.count = (int32_t)s->count;
    fine.mass = s->mass;
    fine.extra = s->n_extra ? s->extra : NULL;
    fine.fixed = s->fixed;
    fine.rule = s->live + s->count;
    fine.excess = s->pool;
    fine.block = s->block;
    fine.factor = s->factor;
    fine.b = s->r;
    fine.x = s->z;
    fine.y = s->room;
    fine.d = s->room + s->count;
    fine.go = go;
    l[0] = fine;
    int levels = 1;
    while (levels == 1 || l[levels - 1].count > COARSEST) {
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
        c.d = v + 3 * (int64_t)c.count;
        c.go = go;
        a += (2 + STENCIL) * (int64_t)c.count;
        v += 4 * (int64_t)c.count;
        l[levels++] = c;
    }
    return levels;
}

/* §4: for eigenvalues of [high / 8, high], in binary64. */
static struct weights weights_of(double high)
{
    double low = high / 8, mid = (high + low) / 2, half = (high - low) / 2;
    double sigma = mid / half, rho = 1 / (2 * sigma - 1 / sigma);
    return weights{(real)(1 / mid), (real)(rho / sigma),
                   (real)(2 * rho / half)};
}

struct opening gpu_multigrid_opening(const struct multigrid *s)
{
    return opening{s->factor, s->room, weights_of(2).first};
}

/* ---- smoothing ---- */

static __device__ bool idle(const struct level *l)
{
    return l->go && !*l->go;
}

/* Thread p owns y[p]. */
static __global__ void __launch_bounds__(GPU_BLOCK)
    multigrid_first_kernel(struct opening o, int32_t count, const vec *b)
{
    ITEM(p, count);
    open_at(&o, (int)p, b[p]);
}

/* A half-step: d = keep·d + gain·F (b - A x), to = x + d. */
struct half {
    const vec *b;
    const sym *factor;
    const vec *d;     /* NULL for 0 */
    vec *to, *next_d; /* next_d: NULL where nothing reads it */
    real *item;       /* NULL, or to[p]·b[p] is wanted there */
    real keep, gain;
};

static __device__ void arrive(const struct half *h, struct place at, vec x,
                              vec y)
{
    vec b = h->b[at.p];
    vec d = scale(h->gain, solved(h->factor[at.p], sub(b, y)));
    if (h->d)
        d = axpy(d, h->keep, h->d[at.p]);
    if (h->next_d)
        h->next_d[at.p] = d;
    vec to = add(x, d);
    h->to[at.p] = to;
    if (h->item)
        h->item[at.p] = dot(b, to);
}

/* to = b - A x, 0 where fixed. */
struct left {
    const vec *b;
    const uint8_t *fixed; /* NULL: all free */
    vec *to;
};

static __device__ void arrive(const struct left *l, struct place at, vec x,
                              vec y)
{
    (void)x;
    bool fixed = l->fixed && l->fixed[at.p];
    l->to[at.p] = fixed ? make(0, 0, 0) : sub(l->b[at.p], y);
}

/* ---- between grids, §2 ---- */

/* Thread p of the coarse grid owns its right-hand side to[p], gathered from
 * the fine residual, and, unless it is the coarsest, its first half-step. */
static __global__ void __launch_bounds__(GPU_BLOCK)
    multigrid_restrict_kernel(struct level f, struct level c, vec *to,
                              real first)
{
    ITEM(item, c.count);
    if (idle(&c))
        return;
    struct place at = place_of(c.g, item);
    vec sum = make(0, 0, 0);
    for (int k = 0; k < 9; k++) {
        int di = k % 3 - 1, dj = k / 3 - 1;
        int x = 2 * at.i + di, y = 2 * at.j + dj, p = x + f.g.m * y;
        if (within(f.g, x, y))
            sum = axpy(sum, R(0.25) * (real)part_of(f.rule[p], di, dj), f.y[p]);
    }
    to[at.p] = sum;
    if (first != 0)
        c.y[at.p] = scale(first, solved(c.factor[at.p], sum));
}

/* x of the fine grid with the correction of the coarse ones around it. */
struct raised {
    const vec *x, *coarse;
    int32_t m;                   /* of the coarse grid */
    const uint8_t *rule, *fixed; /* fixed: NULL: all free */
};

static __device__ vec value_at(const struct raised *s, struct place at)
{
    vec here = s->x[at.p], sum = make(0, 0, 0);
    if (s->fixed && s->fixed[at.p])
        return here;
    int rule = s->rule[at.p];
    for (int y = at.j / 2; y <= (at.j + 1) / 2; y++)
        for (int x = at.i / 2; x <= (at.i + 1) / 2; x++) {
            int part = part_of(rule, at.i - 2 * x, at.j - 2 * y);
            sum = axpy(sum, R(0.25) * (real)part, s->coarse[x + s->m * y]);
        }
    return add(here, sum);
}

/* Thread p of the fine grid owns to[p]. */
static __global__ void __launch_bounds__(GPU_BLOCK)
    multigrid_prolong_kernel(struct level f, struct raised s, vec *to)
{
    ITEM(item, f.count);
    if (!idle(&f))
        to[item] = value_at(&s, place_of(f.g, item));
}

/* ---- the stage ---- */

template <class X, class END>
static void multiply(struct gpu *g, const struct level *l, X x, END end)
{
    struct ties t = {l->g, l->mass, l->extra, l->excess, l->block};
    if (l->mass)
        march<SPRINGS>(g, t, x, end, l->go);
    else
        march<STENCIL>(g, t, x, end, l->go);
}

/* From b to x, the first half-step being in y; then b of the next. */
static void go_down(struct gpu *g, const struct level *l, struct weights w,
                    real next_first)
{
    const struct level *c = l + 1;
    multiply(g, l, plain{l->y},
             half{l->b, l->factor, l->y, l->x, NULL, NULL, w.keep, w.second});
    multiply(g, l, plain{l->x}, left{l->b, l->fixed, l->y});
    LAUNCH(g, c->count, multigrid_restrict_kernel, *l, *c, (vec *)c->b,
           next_first);
}

/* item as in struct half. */
static void go_up(struct gpu *g, const struct level *l, struct weights w,
                  real *item)
{
    const struct level *c = l + 1;
    struct raised x = {l->x, c->x, c->g.m, l->rule, l->fixed};
    struct half one = {l->b, l->factor, NULL, l->y, l->d, NULL, 0, w.first};
    struct half two = {l->b, l->factor, l->d,   l->x,
                       NULL, item,      w.keep, w.second};
    if (l->count >= MARCH_LEAST) {
        multiply(g, l, x, one);
    } else {
        LAUNCH(g, l->count, multigrid_prolong_kernel, *l, x, l->x);
        multiply(g, l, plain{l->x}, one);
    }
    multiply(g, l, plain{l->y}, two);
}

static struct coarsest coarsest_of(const struct multigrid *s,
                                   const struct level *l)
{
    struct coarsest c = {l->g.m,    l->g.n,   l->count,
                         l->excess, l->block, s->dense};
    return c;
}

void gpu_multigrid_cycle(struct gpu *g, struct multigrid *s, const int32_t *go,
                         real *item)
{
    struct level l[LEVELS];
    int last = lay_out(s, go, l) - 1;
    struct weights fine = weights_of(2), coarse = weights_of(2.5);
    for (int k = 0; k < last; k++)
        go_down(g, &l[k], k ? coarse : fine, k + 1 < last ? coarse.first : 0);
    struct coarsest d = coarsest_of(s, &l[last]);
    gpu_coarsest_solve(g, &d, l[last].b, l[last].x, go);
    for (int k = last - 1; k >= 0; k--)
        go_up(g, &l[k], k ? coarse : fine, k ? NULL : item);
}

int gpu_multigrid_build(struct gpu *g, struct multigrid *s)
{
    struct level l[LEVELS];
    struct excess e = {s->m,       s->n,     s->count,    s->mass,
                       s->n_extra, s->extra, s->n_blocks, s->block,
                       s->fixed,   s->pool,  s->live,     s->live + s->count};
    int status = gpu_excess(g, &e);
    int levels = status == DRAPE_OK ? lay_out(s, NULL, l) : 0;
    for (int k = 1; k < levels && status == DRAPE_OK; k++) {
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
        status = gpu_coarsen(g, &c);
    }
    if (status == DRAPE_OK) {
        struct coarsest d = coarsest_of(s, &l[levels - 1]);
        gpu_coarsest_factor(g, &d);
    }
    return status;
}

int gpu_multigrid(struct gpu *g, struct multigrid *s)
{
    int status = gpu_multigrid_build(g, s);
    if (status == DRAPE_OK) {
        LAUNCH(g, s->count, multigrid_first_kernel, gpu_multigrid_opening(s),
               (int32_t)s->count, s->r);
        gpu_multigrid_cycle(g, s, NULL, NULL);
    }
    return status == DRAPE_OK ? gpu_status(g) : status;
}
