/* SPDX-License-Identifier: Apache-2.0 */
/* Conjugate gradients over all cloths and their contacts, on the device: the
 * host queues iterations, and the device decides when they end.
 * spec/contact/penalty.md §4 */
#include "gpu/base/sum.cuh"
#include "gpu/contact/links.cuh"
#include "gpu/run/loop.cuh"
#include "gpu/run/merge.cuh"
#include "gpu/solve/pcg.cuh"

extern "C" {
#include "gpu/contact/joint.h"
#include "ref/solve/product.h"
}

/* Iterations that are queued before the first readback, and in each turn of a
 * loop. Both are even, as directions alternate between two streams. */
enum { FIRST = 4, NEXT = 2 };

/* The state of a joint solve, with what differs from one solve to the next: no
 * captured kernel takes it as an argument, so that few graphs are captured. */
struct joint_state : pcg_state {
    real tolerance, exact; /* as in struct joint */
    const vec *last;
};

static_assert(sizeof(struct joint_state) <= GPU_WORDS * sizeof(int64_t),
              "words");

/* How M⁻¹ r begins: by Jacobi s and item = r·s; by multigrid the first
 * smoothing of the cycle. */
struct beginning {
    int32_t with_r; /* 1: there is one cloth: whoever makes r begins, too */
    int32_t jacobi;
    struct opening opening;
    const sym *factor;
    vec *s;
    real *item;
};

/* Of the last step, by Jacobi. */
#define LAST_PART (R(2.0) / 3)

/* What the launches of a solve depend on: the key of its graphs, too. The
 * contacts are in device memory. */
struct solve {
    struct pcg rule;       /* energy and max_iterations of the whole */
    struct joint_state *c; /* device */
    struct linked *links;  /* device */
    int64_t nc, n_chunks;
    vec *r, *p[2], *q, *dv;
    const vec *b;
    const real *w; /* [nv] 1/kg, 0: fixed */
    const sym *wall;
    real *item, *chunk;
    int32_t touch;   /* 1: there are contacts */
    int32_t recalls; /* 1: begins along c->last */
    int32_t weigh;   /* as in struct joint */
    int32_t epoch;   /* likewise */
    struct beginning begin;
};

/* Block k of the kernels below owns chunk k of the particles, a thread each
 * particle; the block that ends last writes the next state. */
#define PARTICLE(k) int64_t k = (int64_t)blockIdx.x * SUM_CHUNK + threadIdx.x

/* One thread writes the state before the solve. */
KERNEL joint_keep_kernel(struct joint_state *c, const struct joint_state &fresh)
{
    *c = fresh;
}

static __device__ void begin_at(const struct beginning *b, int64_t k, vec r)
{
    if (!b->jacobi) {
        open_at(&b->opening, (int)k, r);
        return;
    }
    vec z = solved(b->factor[k], r);
    b->s[k] = z;
    b->item[k] = dot(r, z);
}

/* r = b and dv = 0, p[0] = c->last; the state before the first iteration. */
KERNEL joint_open_kernel(const struct solve &a)
{
    PARTICLE(k);
    struct joint_state *c = a.c;
    real value = 0, sum;
    if (k < a.nc) {
        vec r = a.b[k];
        a.r[k] = r;
        value = dot(r, r);
        if (a.begin.with_r && (a.weigh || !a.recalls))
            begin_at(&a.begin, k, r);
        if (a.recalls)
            a.p[0][k] = c->last[k];
    }
    if (!grid_sums<1>(&value, a.chunk, &c->ticket, &sum) || threadIdx.x)
        return;
    c->square = c->left = sum;
    c->most = max_of(sum, c->most);
    c->outcome = PCG_CONVERGED;
    c->phase = PHASE_DONE;
    if (sum == 0)
        return;
    c->first = c->go = 1;
    c->phase = PHASE_ITERATE;
    if (!positive(sum))
        end(c, PCG_BREAKDOWN);
    else if (a.rule.max_iterations <= 0)
        end(c, PCG_LIMIT);
}

/* Thread k owns particle k of one cloth. */
KERNEL joint_begin_kernel(const struct beginning &b, int64_t count,
                          const vec *r, const int32_t *go)
{
    ITEM(k, count);
    if (*go)
        begin_at(&b, k, r[k]);
}

/* The sum of item: r·M⁻¹r. */
KERNEL joint_enter_kernel(const struct solve &a)
{
    struct joint_state *c = a.c;
    real sum;
    if (!c->go || !item_sum(a.nc, a.item, a.chunk, &c->ticket, &sum) ||
        threadIdx.x)
        return;
    enter(&a.rule, c, sum, c->tolerance, c->exact);
}

/* The same of b: what the tolerance is relative to. */
KERNEL joint_weigh_kernel(const struct solve &a)
{
    struct pcg_state *c = a.c;
    real sum;
    if (c->go && item_sum(a.nc, a.item, a.chunk, &c->ticket, &sum) &&
        threadIdx.x == 0)
        c->from = max_of(sum, c->from);
}

/* q = A p, 0 where fixed, gains what the contacts push; then p·q and p·r, which
 * give the α of a step along p, whatever it is. */
KERNEL joint_recall_kernel(const struct solve &a, const vec *p)
{
    PARTICLE(k);
    struct pcg_state *c = a.c;
    real value[2] = {0, 0}, sum[2];
    if (!c->go)
        return;
    if (k < a.nc && !(a.w[k] > 0))
        a.q[k] = make(0, 0, 0);
    __syncthreads();
    if (a.touch)
        gather_links(a.links, a.nc, a.q);
    __syncthreads();
    if (k < a.nc) {
        value[0] = dot(p[k], a.q[k]);
        value[1] = dot(p[k], a.r[k]);
    }
    if (!grid_sums<2>(value, a.chunk, &c->ticket, sum) || threadIdx.x)
        return;
    real alpha = positive(sum[0]) ? sum[1] / sum[0] : 0;
    c->alpha = alpha - alpha == 0 ? alpha : 0;
}

/* q gains what the contacts push; then p·q, which gives α. */
KERNEL joint_measure_kernel(const struct solve &a, const vec *p)
{
    PARTICLE(k);
    struct pcg_state *c = a.c;
    real value = 0, sum;
    static_assert((int)LIST_BLOCK == (int)SUM_CHUNK, "a thread's particle");
    if (!c->go)
        return;
    if (a.touch)
        gather_links(a.links, a.nc, a.q);
    __syncthreads();
    if (k < a.nc)
        value = dot(p[k], a.q[k]);
    if (grid_sums<1>(&value, a.chunk, &c->ticket, &sum) && threadIdx.x == 0)
        measure(c, sum);
}

/* dv += α p, r -= α q, and |r|². first: 1 if the next direction does not depend
 * on p. */
KERNEL joint_update_kernel(const struct solve &a, const vec *p, int first)
{
    PARTICLE(k);
    struct pcg_state *c = a.c;
    real value = 0, sum, alpha = c->alpha;
    if (!c->go)
        return;
    if (k < a.nc) {
        vec r = a.r[k];
        if (alpha != 0) { /* else p may not be finite */
            r = axpy(r, -alpha, a.q[k]);
            a.dv[k] = axpy(a.dv[k], alpha, p[k]);
            a.r[k] = r;
        }
        value = dot(r, r);
        if (a.begin.with_r)
            begin_at(&a.begin, k, r);
    }
    if (!grid_sums<1>(&value, a.chunk, &c->ticket, &sum) || threadIdx.x)
        return;
    leave(&a.rule, c, sum);
    c->first = first;
}

/* Thread k owns particle k of one cloth. */
KERNEL joint_improve_kernel(const struct pcg_state *c, int64_t count, vec *dv,
                            const vec *s, real part)
{
    ITEM(k, count);
    if (c->outcome == PCG_CONVERGED && c->iterations > 0)
        dv[k] = axpy(dv[k], part, s[k]);
}

/* Thread k owns particle k: p[0] = wall dv. */
KERNEL joint_walls_kernel(const struct solve &a)
{
    ITEM(k, a.nc);
    a.p[0][k] = apply(a.wall[k], a.dv[k]);
}

/* The true residual: q = A dv, 0 where fixed, and `other` is the contacts'
 * part of the product. */
KERNEL joint_conclude_kernel(const struct solve &a, const vec *other)
{
    PARTICLE(k);
    struct pcg_state *c = a.c;
    real value = 0, sum;
    if (k < a.nc) {
        vec q = a.w[k] > 0 ? a.q[k] : make(0, 0, 0);
        vec r = sub(sub(a.b[k], q), other[k]);
        a.q[k] = q;
        a.r[k] = r;
        value = dot(r, r);
    }
    if (!grid_sums<1>(&value, a.chunk, &c->ticket, &sum) || threadIdx.x)
        return;
    c->residual = c->square == 0 ? 0 : root(sum / c->most);
}

/* The system of one cloth, whose residual is its part of the joint one. */
static struct pcg part_of(const struct joint_system *w,
                          const struct joint_part *s)
{
    const struct joint *a = w->joint;
    struct pcg p = s->pcg;
    p.n_extra = p.count;
    p.extra = a->hold + s->first;
    p.r = a->r + s->first;
    p.dv = a->dv + s->first;
    p.n_z = 0;
    p.z = NULL;
    p.fell_back = 0;
    pcg_open(&p);
    return p;
}

/* Writes all but with_r of *b, which is part of a key: padding stays as it is.
 * item: [p->count], of that cloth. */
static void write_begin(struct beginning *b, struct pcg *p, real *item)
{
    b->jacobi = p->precond == DRAPE_JACOBI;
    if (!b->jacobi) {
        struct opening o = gpu_multigrid_opening(&p->grid);
        b->opening.factor = o.factor;
        b->opening.y = o.y;
        b->opening.damping = o.damping;
    }
    b->factor = p->factor;
    b->s = p->s;
    b->item = item;
}

/* The most particles of a cloth whose launches are merged with others'. Larger
 * cloths fill the device, and run beside each other in branches. */
enum { SMALL_CLOTH = 1 << 14 };

/* Cloths from k on that make the same launches, and so few particles that they
 * are merged. */
static int alike(const struct joint_system *w, int k)
{
    const struct pcg *a = &w->part[k].pcg;
    int n = 1;
    if (a->count > SMALL_CLOTH || a->n_cdf || w->part[k].rate)
        return n;
    for (; k + n < w->n && n < MERGE_MOST; n++) {
        const struct pcg *b = &w->part[k + n].pcg;
        if (a->m != b->m || a->n != b->n || b->n_cdf || w->part[k + n].rate ||
            a->precond != b->precond || a->triples != b->triples ||
            a->n_thin != b->n_thin)
            break;
    }
    return n;
}

/* Cloths' own launches run beside each other. */
static void fork_cloths(const struct joint_system *w)
{
    if (w->n > 1)
        gpu_fork(w->gpu);
}

static void branch_to(const struct joint_system *w, int k)
{
    if (w->n > 1)
        gpu_branch(w->gpu, k);
}

static void join_cloths(const struct joint_system *w)
{
    if (w->n > 1)
        gpu_join(w->gpu);
}

/* Calls launch(k) for each cloth k: those that are alike are merged, and what
 * is not runs beside each other. */
template <class F> static int each_cloth(const struct joint_system *w, F launch)
{
    struct gpu *g = w->gpu;
    int status = DRAPE_OK, branch = 0;
    fork_cloths(w);
    for (int k = 0, n; k < w->n && status == DRAPE_OK; k += n) {
        n = alike(w, k);
        branch_to(w, branch++);
        if (n > 1)
            gpu_merge_open(g);
        for (int c = 0; c < n && status == DRAPE_OK; c++) {
            gpu_merge_next(g);
            status = launch(k + c);
        }
        gpu_merge_close(g);
    }
    join_cloths(w);
    return status;
}

/* s = M⁻¹ r and item = r·s of all cloths. */
static void cycle(const struct joint_system *w, const struct solve *a)
{
    struct gpu *g = w->gpu;
    each_cloth(w, [&](int k) {
        struct pcg p = part_of(w, &w->part[k]);
        struct beginning b = {};
        write_begin(&b, &p, a->item + w->part[k].first);
        if (!a->begin.with_r)
            MERGE(g, p.count,
                  (b, p.count, (const vec *)p.r, (const int32_t *)&a->c->go),
                  joint_begin_kernel);
        if (!b.jacobi)
            gpu_multigrid_cycle(g, &p.grid, lent_by(&p), &a->c->go, b.item);
        return (int)DRAPE_OK;
    });
}

/* The next direction `to` = s + β from and its image q. */
static void search(const struct joint_system *w, const struct solve *a,
                   const vec *from, vec *to)
{
    struct gpu *g = w->gpu;
    each_cloth(w, [&](int k) {
        const struct joint_part *s = &w->part[k];
        struct pcg p = part_of(w, s);
        p.extra = w->joint->wall + s->first;
        p.q = a->q + s->first;
        gpu_pcg_search(g, &p,
                       {a->c, s->rate, from + s->first, to + s->first,
                        a->item + s->first});
        return (int)DRAPE_OK;
    });
    if (a->touch)
        gpu_links_push(g, a->links, to, &a->c->go);
    LAUNCH_BLOCKS(g, a->n_chunks, SUM_CHUNK, joint_measure_kernel, *a, to);
}

static void iterate(const struct joint_system *w, const struct solve *a,
                    int times)
{
    for (int k = 0; k < times; k++) {
        const vec *from = a->p[k % 2];
        vec *to = a->p[(k + 1) % 2];
        cycle(w, a);
        LAUNCH_BLOCKS(w->gpu, item_blocks(a->nc), SUM_CHUNK, joint_enter_kernel,
                      *a);
        search(w, a, from, to);
        LAUNCH_BLOCKS(w->gpu, a->n_chunks, SUM_CHUNK, joint_update_kernel, *a,
                      to, 0);
    }
}

/* y = A x of each cloth, or (A + wall) x. */
static void multiply(const struct joint_system *w, bool with_walls,
                     const vec *x, vec *y)
{
    struct gpu *g = w->gpu;
    each_cloth(w, [&](int k) {
        const struct joint_part *s = &w->part[k];
        const struct pcg *p = &s->pcg;
        struct product m = {.m = p->m,
                            .n = p->n,
                            .count = p->count,
                            .mass = p->mass,
                            .n_extra = with_walls ? p->count : 0,
                            .extra = w->joint->wall + s->first,
                            .n_blocks = p->n_cdf ? 0 : p->n_blocks,
                            .block = p->block,
                            .n_cdf = p->n_cdf,
                            .cdf = p->cdf,
                            .x = x + s->first,
                            .y = y + s->first};
        return gpu_product(g, &m);
    });
}

/* §4.5: a step along p[0] = last. */
static void recall(const struct joint_system *w, const struct solve *a)
{
    struct gpu *g = w->gpu;
    const vec *p = a->p[0];
    if (a->weigh) {
        cycle(w, a);
        LAUNCH_BLOCKS(g, item_blocks(a->nc), SUM_CHUNK, joint_weigh_kernel, *a);
    }
    multiply(w, true, p, a->q);
    if (a->touch)
        gpu_links_push(g, a->links, p, &a->c->go);
    LAUNCH_BLOCKS(g, a->n_chunks, SUM_CHUNK, joint_recall_kernel, *a, p);
    LAUNCH_BLOCKS(g, a->n_chunks, SUM_CHUNK, joint_update_kernel, *a, p, 1);
}

/* Queues the preconditioners, the first residual and the first iterations. */
static int begin(const struct joint_system *w, const struct solve *a)
{
    struct gpu *g = w->gpu;
    int status = each_cloth(w, [&](int k) {
        struct pcg p = part_of(w, &w->part[k]);
        return gpu_pcg_set_up(g, &p);
    });
    LAUNCH_BLOCKS(g, a->n_chunks, SUM_CHUNK, joint_open_kernel, *a);
    if (a->recalls)
        recall(w, a);
    iterate(w, a, FIRST);
    return status;
}

/* A last step along M⁻¹ r, which the test of the tolerance has left in s. */
static void improve(const struct joint_system *w, const struct solve *a)
{
    each_cloth(w, [&](int k) {
        struct pcg p = part_of(w, &w->part[k]);
        real part = p.precond == DRAPE_JACOBI ? LAST_PART : R(1.0);
        MERGE(w->gpu, p.count,
              ((const struct pcg_state *)a->c, p.count, p.dv, (const vec *)p.s,
               part),
              joint_improve_kernel);
        return (int)DRAPE_OK;
    });
}

/* q = A dv and the true residual. */
static void conclude(const struct joint_system *w, const struct solve *a)
{
    struct gpu *g = w->gpu;
    improve(w, a);
    multiply(w, false, a->dv, a->q);
    LAUNCH(g, a->nc, joint_walls_kernel, *a);
    if (a->touch)
        gpu_links_queue(g, a->links, a->nc, a->dv, a->p[0], NULL);
    LAUNCH_BLOCKS(g, a->n_chunks, SUM_CHUNK, joint_conclude_kernel, *a,
                  a->p[0]);
}

static struct pcg_state read_state(struct gpu *g)
{
    struct pcg_state seen;
    int words = (int)((sizeof seen + sizeof(int64_t) - 1) / sizeof(int64_t));
    memcpy((void *)&seen, gpu_read_back_keep(g, words), sizeof seen);
    return seen;
}

/* Queues the whole solve as one graph; or runs it, if the host is to end the
 * iterations. */
static int run(const struct joint_system *w, const struct solve *a)
{
    struct gpu *g = w->gpu;
    auto first = [&] { return begin(w, a); };
    auto next = [&] {
        iterate(w, a, NEXT);
        return (int)DRAPE_OK;
    };
    auto last = [&] {
        conclude(w, a);
        return (int)DRAPE_OK;
    };
    if (gpu_loop(g, loop_key{a, sizeof *a}, {&a->c->go, first, next, last}))
        return gpu_status(g);
    int status = first();
    while (status == DRAPE_OK && read_state(g).go) {
        next();
        if (g->together) /* a look costs more there than idle kernels */
            next();
        status = gpu_status(g);
    }
    return status == DRAPE_OK ? last() : status;
}

static void write_solve(struct solve *a, const struct joint_system *w)
{
    const struct joint *s = w->joint;
    memset((void *)a, 0, sizeof *a); /* padding, too: it is a key */
    a->rule.energy = 1;
    a->rule.max_iterations = s->max_iterations;
    a->c = (struct joint_state *)gpu_words(w->gpu);
    a->links = w->links;
    a->touch = s->links.n > 0;
    a->nc = s->nc;
    a->n_chunks = s->n_chunks;
    a->r = s->r;
    a->p[0] = s->p;
    a->p[1] = s->p2;
    a->q = s->q;
    a->dv = s->dv;
    a->b = s->b;
    a->recalls = s->last != NULL;
    a->weigh = s->weigh;
    a->epoch = s->epoch;
    a->w = w->w;
    a->wall = s->wall;
    a->item = s->item;
    a->chunk = s->chunk;
    if (w->n > 1 || w->part[0].pcg.count < s->nc)
        return;
    struct pcg only = part_of(w, &w->part[0]);
    write_begin(&a->begin, &only, s->item);
    a->begin.with_r = 1;
}

static struct joint_state fresh_state(const struct joint *s)
{
    struct joint_state c = {};
    c.from = s->scale;
    c.most = s->square;
    c.tolerance = s->tolerance;
    c.exact = s->exact;
    c.last = s->last;
    return c;
}

int gpu_joint(const struct joint_system *w)
{
    struct joint *s = w->joint;
    struct gpu *g = w->gpu;
    struct solve a;
    gpu_hand_over(g);
    write_solve(&a, w);
    LAUNCH(g, 1, joint_keep_kernel, a.c, fresh_state(s));
    if (a.touch)
        gpu_links_keep(g, &s->links, s->nc, a.links, w->mutual_end, w->mutual);
    int status = run(w, &a);
    if (status != DRAPE_OK)
        return status;
    struct pcg_state c = read_state(g);
    s->scale = c.from;
    s->square = c.most;
    s->iterations = c.iterations;
    s->outcome = c.outcome;
    s->residual = c.residual;
    return gpu_status(g);
}
