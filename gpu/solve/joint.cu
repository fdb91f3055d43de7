/* SPDX-License-Identifier: Apache-2.0 */
/* Conjugate gradients over all cloths and their contacts, on the device: the
 * host queues iterations, and the device decides when they end.
 * spec/contact/lagrange.md §3.2 */
#include "gpu/base/sum.cuh"
#include "gpu/contact/links.cuh"
#include "gpu/run/loop.cuh"
#include "gpu/run/merge.cuh"
#include "gpu/solve/pcg.cuh"

extern "C" {
#include "gpu/contact/joint.h"
#include "gpu/solve/sewn.h"
#include "ref/solve/product.h"
}

/* Iterations that are queued before the first readback, and in each chunk of a
 * loop. Both are even, as directions alternate between two streams. */
enum { FIRST = 4, NEXT = 2 };

/* The state of a joint solve, with what differs from one solve to the next: no
 * captured kernel takes it as an argument, so that few graphs are captured. */
struct joint_state : pcg_state {
    real tolerance;         /* as in struct joint */
    int32_t max_iterations; /* likewise */
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

/* What a graph does: makes M, finds r·M⁻¹ r, or solves. */
enum task { SET_UP, MEASURE, SOLVE };

/* What the launches of a task depend on: the key of its graph, too. The
 * contacts are in device memory. */
struct solve {
    struct joint_state *c; /* device */
    struct linked *links;  /* device */
    int64_t nc, n_chunks;
    vec *r, *p[2], *q, *dv;
    const vec *b;  /* or the r of MEASURE */
    const real *w; /* [nv] 1/kg, 0: fixed */
    const sym *bound, *single;
    real *item, *chunk;
    int32_t task;
    int32_t touch; /* 1: there are contacts */
    int32_t epoch; /* as in struct joint */
    struct beginning begin;
};

/* Block k of the kernels below that have sums owns chunk k of the particles, a
 * thread each particle; the block that ends last writes the next state. */
#define PARTICLE(k) int64_t k = (int64_t)blockIdx.x * SUM_CHUNK + threadIdx.x

/* One thread writes the state before a task. */
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

/* Thread k owns particle k: r = b and dv = 0. */
KERNEL joint_open_kernel(const struct solve &a)
{
    ITEM(k, a.nc);
    vec r = a.b[k];
    a.r[k] = r;
    a.dv[k] = make(0, 0, 0);
    if (a.begin.with_r)
        begin_at(&a.begin, k, r);
}

/* Thread k owns particle k of one cloth. */
KERNEL joint_begin_kernel(const struct beginning &b, int64_t count,
                          const vec *r, const int32_t *go)
{
    ITEM(k, count);
    if (*go)
        begin_at(&b, k, r[k]);
}

/* The sum of item: r·M⁻¹r, which is all that MEASURE asks for. */
KERNEL joint_value_kernel(const struct solve &a)
{
    struct joint_state *c = a.c;
    real sum;
    if (item_sum(a.nc, a.item, a.chunk, &c->ticket, &sum) && threadIdx.x == 0)
        c->from = sum;
}

/* Called after the preconditioner. next: r·M⁻¹r, which gives β. */
static __device__ void enter_next(struct joint_state *c, real next)
{
    if (c->iterations >= c->max_iterations) {
        end(c, PCG_LIMIT);
        return;
    }
    c->first = c->iterations == 0;
    if (c->first)
        c->from = next;
    if (next == 0 || root(next / c->from) <= c->tolerance) {
        end(c, PCG_CONVERGED);
    } else if (!positive(next)) {
        end(c, PCG_BREAKDOWN);
    } else {
        c->beta = c->first ? 0 : next / c->rho;
        c->rho = next;
    }
}

/* The sum of item: r·M⁻¹r. */
KERNEL joint_enter_kernel(const struct solve &a)
{
    struct joint_state *c = a.c;
    real sum;
    if (c->go && item_sum(a.nc, a.item, a.chunk, &c->ticket, &sum) &&
        threadIdx.x == 0)
        enter_next(c, sum);
}

/* q gains what the contacts push; then p·q, which gives α. */
KERNEL joint_curvature_kernel(const struct solve &a, const vec *p)
{
    PARTICLE(k);
    struct joint_state *c = a.c;
    real value = 0, sum;
    static_assert((int)LIST_BLOCK == (int)SUM_CHUNK, "a thread's particle");
    if (!c->go)
        return;
    if (a.touch)
        gather_links(a.links, a.nc, a.q);
    __syncthreads();
    if (k < a.nc)
        value = dot(p[k], a.q[k]);
    if (!grid_sums<1>(&value, a.chunk, &c->ticket, &sum) || threadIdx.x)
        return;
    measure(c, sum);
    c->iterations += c->go; /* the step along p follows */
}

/* Thread k owns particle k: dv += α p, r -= α q. */
KERNEL joint_update_kernel(const struct solve &a, const vec *p)
{
    ITEM(k, a.nc);
    real alpha = a.c->alpha;
    if (!a.c->go)
        return;
    vec r = a.r[k];
    if (alpha != 0) { /* else p may not be finite */
        r = axpy(r, -alpha, a.q[k]);
        a.dv[k] = axpy(a.dv[k], alpha, p[k]);
        a.r[k] = r;
    }
    if (a.begin.with_r)
        begin_at(&a.begin, k, r);
}

/* Thread k owns particle k of one cloth. */
KERNEL joint_improve_kernel(const struct pcg_state *c, int64_t count, vec *dv,
                            const vec *s, real part)
{
    ITEM(k, count);
    if (c->outcome == PCG_CONVERGED && c->iterations > 0)
        dv[k] = axpy(dv[k], part, s[k]);
}

/* Thread k owns particle k: q is 0 where fixed. */
KERNEL joint_conclude_kernel(const struct solve &a)
{
    ITEM(k, a.nc);
    if (!(a.w[k] > 0))
        a.q[k] = make(0, 0, 0);
}

/* The system of one cloth, whose residual is its part of the joint one. */
static struct pcg part_of(const struct joint_system *w,
                          const struct joint_part *s)
{
    const struct joint *a = w->joint;
    struct pcg p = s->pcg;
    p.n_extra = p.count;
    p.extra = a->bound + s->first;
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
            a->n_packed != b->n_packed)
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

/* The finest grid of a cloth in a cycle with seams. */
static struct level finest(struct pcg *p)
{
    struct level l[LEVELS];
    gpu_multigrid_lay_out(&p->grid, lent_by(p), NULL, l);
    return l[0];
}

/* Between the opening of a cycle with seams and its end: sewn.md §3. */
static void cycle_sewn(const struct joint_system *w, const struct solve *a)
{
    struct gpu *g = w->gpu;
    const int32_t *go = &a->c->go;
    gpu_sewn_cycle(g, w->sewn, go);
    each_cloth(w, [&](int k) {
        struct pcg p = part_of(w, &w->part[k]);
        struct level l = finest(&p);
        l.go = go;
        gpu_multigrid_smooth(g, &l, gpu_multigrid_damping(&p.grid, 0),
                             a->item + w->part[k].first);
        return (int)DRAPE_OK;
    });
    gpu_sewn_finish(g, w->sewn, go);
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
        if (w->sewn) {
            struct level l = finest(&p);
            l.go = &a->c->go;
            gpu_multigrid_descend(g, &l);
        } else if (!b.jacobi) {
            gpu_multigrid_cycle(g, &p.grid, lent_by(&p), &a->c->go, b.item);
        }
        return (int)DRAPE_OK;
    });
    if (w->sewn)
        cycle_sewn(w, a);
}

/* The next direction `to` = s + β from and its image q. */
static void search(const struct joint_system *w, const struct solve *a,
                   const vec *from, vec *to)
{
    struct gpu *g = w->gpu;
    each_cloth(w, [&](int k) {
        const struct joint_part *s = &w->part[k];
        struct pcg p = part_of(w, s);
        p.extra = w->joint->single + s->first;
        p.q = a->q + s->first;
        gpu_pcg_search(g, &p,
                       {a->c, s->rate, from + s->first, to + s->first,
                        a->item + s->first});
        return (int)DRAPE_OK;
    });
    if (a->touch)
        gpu_links_push(g, a->links, to, &a->c->go);
    LAUNCH_BLOCKS(g, a->n_chunks, SUM_CHUNK, joint_curvature_kernel, *a, to);
}

static void iterate_gradients(const struct joint_system *w,
                              const struct solve *a, int times)
{
    for (int k = 0; k < times; k++) {
        const vec *from = a->p[k % 2];
        vec *to = a->p[(k + 1) % 2];
        cycle(w, a);
        LAUNCH_BLOCKS(w->gpu, item_blocks(a->nc), SUM_CHUNK, joint_enter_kernel,
                      *a);
        search(w, a, from, to);
        LAUNCH(w->gpu, a->nc, joint_update_kernel, *a, to);
    }
}

/* A last step along M⁻¹ r, which the test of the tolerance has left in s. */
static void improve_solution(const struct joint_system *w,
                             const struct solve *a)
{
    each_cloth(w, [&](int k) {
        struct pcg p = part_of(w, &w->part[k]);
        real part = p.precond == DRAPE_JACOBI ? JOINT_LAST_PART : R(1.0);
        MERGE(w->gpu, p.count,
              ((const struct pcg_state *)a->c, p.count, p.dv, (const vec *)p.s,
               part),
              joint_improve_kernel);
        return (int)DRAPE_OK;
    });
}

/* q = A dv of each cloth. */
static void multiply_matrix(const struct joint_system *w, const struct solve *a)
{
    struct gpu *g = w->gpu;
    each_cloth(w, [&](int k) {
        const struct joint_part *s = &w->part[k];
        const struct pcg *p = &s->pcg;
        struct product m = pcg_product(p, a->dv + s->first, a->q + s->first);
        m.n_extra = 0;
        return gpu_product(g, &m);
    });
    LAUNCH(g, a->nc, joint_conclude_kernel, *a);
}

static struct pcg_state read_state(struct gpu *g)
{
    struct pcg_state seen;
    int words = (int)((sizeof seen + sizeof(int64_t) - 1) / sizeof(int64_t));
    memcpy((void *)&seen, gpu_read_back_keep(g, words), sizeof seen);
    return seen;
}

/* The three tasks: each queues its launches, as one graph unless the host is to
 * launch them. */

/* What the cycle with seams takes. */
static void put_cloths(const struct joint_system *w)
{
    struct sewn *s = w->sewn;
    gpu_sewn_clear(s);
    for (int k = 0; k < w->n; k++) {
        const struct joint_part *part = &w->part[k];
        struct pcg p = part_of(w, part);
        gpu_sewn_put(s, part->cloth, &p.grid, lent_by(&p),
                     w->joint->item + part->first);
    }
    gpu_sewn_send(w->gpu, s);
}

static int set_up(const struct joint_system *w, const struct solve *a)
{
    struct gpu *g = w->gpu;
    auto all = [&] {
        int status = each_cloth(w, [&](int k) {
            struct pcg p = part_of(w, &w->part[k]);
            return gpu_pcg_prepare(g, &p);
        });
        if (w->sewn)
            gpu_sewn_set_up(g, w->sewn);
        return status;
    };
    bool done = gpu_loop(g, loop_key{a, sizeof *a}, {NULL, all, {}, {}});
    return done ? gpu_status(g) : all();
}

static int find_value(const struct joint_system *w, const struct solve *a)
{
    struct gpu *g = w->gpu;
    auto all = [&] {
        LAUNCH(g, a->nc, joint_open_kernel, *a);
        cycle(w, a);
        LAUNCH_BLOCKS(g, item_blocks(a->nc), SUM_CHUNK, joint_value_kernel, *a);
        return (int)DRAPE_OK;
    };
    bool done = gpu_loop(g, loop_key{a, sizeof *a}, {NULL, all, {}, {}});
    return done ? gpu_status(g) : all();
}

static int run(const struct joint_system *w, const struct solve *a)
{
    struct gpu *g = w->gpu;
    auto first = [&] {
        LAUNCH(g, a->nc, joint_open_kernel, *a);
        iterate_gradients(w, a, FIRST);
        return (int)DRAPE_OK;
    };
    auto next = [&] {
        iterate_gradients(w, a, NEXT);
        return (int)DRAPE_OK;
    };
    auto last = [&] {
        improve_solution(w, a);
        multiply_matrix(w, a);
        return (int)DRAPE_OK;
    };
    if (gpu_loop(g, loop_key{a, sizeof *a}, {&a->c->go, first, next, last}))
        return gpu_status(g);
    first();
    while (gpu_status(g) == DRAPE_OK && read_state(g).go) {
        next();
        if (g->together) /* a look costs more there than idle kernels */
            next();
    }
    last();
    return gpu_status(g);
}

static void write_solve(struct solve *a, const struct joint_system *w,
                        enum task task, const vec *b)
{
    const struct joint *s = w->joint;
    memset((void *)a, 0, sizeof *a); /* padding, too: it is a key */
    a->task = task;
    a->touch = task == SOLVE && s->links.n > 0;
    a->epoch = s->epoch;
    a->bound = s->bound;
    if (task == SET_UP)
        return;
    a->c = (struct joint_state *)gpu_words(w->gpu);
    a->links = w->links;
    a->nc = s->nc;
    a->n_chunks = s->n_chunks;
    a->r = s->r;
    a->p[0] = s->p;
    a->p[1] = s->p2;
    a->q = s->q;
    a->dv = s->dv;
    a->b = b;
    a->w = w->w;
    a->single = s->single;
    a->item = s->item;
    a->chunk = s->chunk;
    if (w->n > 1 || w->part[0].pcg.count < s->nc)
        return;
    struct pcg only = part_of(w, &w->part[0]);
    write_begin(&a->begin, &only, s->item);
    a->begin.with_r = 1;
}

int gpu_joint_system_set_up(const struct joint_system *w)
{
    struct solve a;
    gpu_hand_over(w->gpu);
    write_solve(&a, w, SET_UP, NULL);
    if (w->sewn)
        put_cloths(w);
    int status = set_up(w, &a);
    gpu_hand_over(w->gpu);
    return status;
}

int gpu_joint_system_measure(const struct joint_system *w, const vec *r,
                             real *value)
{
    struct gpu *g = w->gpu;
    struct joint_state fresh = {};
    struct solve a;
    gpu_hand_over(g);
    write_solve(&a, w, MEASURE, r);
    fresh.go = 1;
    LAUNCH(g, 1, joint_keep_kernel, a.c, fresh);
    int status = find_value(w, &a);
    if (status != DRAPE_OK)
        return status;
    *value = read_state(g).from;
    gpu_hand_over(g);
    return gpu_status(g);
}

int gpu_joint_system_solve(const struct joint_system *w)
{
    struct joint *s = w->joint;
    struct gpu *g = w->gpu;
    struct joint_state fresh = {};
    struct solve a;
    gpu_hand_over(g);
    write_solve(&a, w, SOLVE, s->b);
    fresh.go = 1;
    fresh.tolerance = s->tolerance;
    fresh.max_iterations = s->max_iterations;
    LAUNCH(g, 1, joint_keep_kernel, a.c, fresh);
    if (a.touch)
        gpu_links_keep(g, &s->links, s->nc, a.links, w->mutual_end, w->mutual);
    int status = run(w, &a);
    if (status != DRAPE_OK)
        return status;
    struct pcg_state c = read_state(g);
    s->iterations = c.iterations;
    s->outcome = c.outcome;
    gpu_hand_over(g);
    return gpu_status(g);
}
