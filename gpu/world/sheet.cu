/* SPDX-License-Identifier: Apache-2.0 */
/* Takes the streams of a cloth on the device: a copy of the host's cloth whose
 * streams are replaced one by one. spec/gpu.md §6, §10 */
extern "C" {
#include "gpu/cloth/motion.h"
#include "gpu/cloth/rate.h"
#include "gpu/world/sheet.h"
#include "gpu/world/state.h"
#include "ref/base/packed.h"
#include "ref/base/sum.h"
#include "ref/solve/matrix.h"
}

/* Lays out streams one behind the other in one block; without a block it only
 * adds up their sizes. */
struct row {
    char *block;
    size_t at;
};

static void *next_in(struct row *row, int64_t n, size_t size)
{
    size_t align = 256, at = row->at; /* the alignment of cudaMalloc */
    row->at = (at + (size_t)n * size + align - 1) / align * align;
    return row->block ? row->block + at : NULL;
}

#define NEXT(p, n) (p) = (decltype(p))next_in(&row, n, sizeof *(p))

/* Lays out the streams of a cloth's solver in one block, or without a block
 * finds its size. The preconditioner and the matrix come first, then the
 * scratch of solves and of motions, of which the wind's sum is the last. pool
 * of multigrid lacks the part for the finest grid that p and q lend it. */
static struct row lay_out(struct sheet *s, int64_t vecs, char *block)
{
    struct row row = {block, 0};
    struct pcg *p = &s->solver.pcg;
    int64_t lent = p->grid.n_pool ? p->count : 0;
    NEXT(p->factor, p->count);
    NEXT(p->grid.pool, p->grid.n_pool - lent);
    NEXT(p->grid.live, p->grid.n_live);
    NEXT(p->cdf, p->n_cdf);
    NEXT(p->diagonal, p->n_cdf ? p->count : 0);
    NEXT(p->low, p->count);
    NEXT(p->r, p->count);
    NEXT(p->s, p->count);
    NEXT(p->grid.room, p->grid.n_room);
    NEXT(p->p, (2 + vecs) * p->count);
    return row;
}

/* Lends what a solve writes before it reads it. solves: contacts take part in
 * solves, between which the preconditioner, the matrix and the wind stay. */
static void lend(struct gpu *g, const struct sheet *s, int64_t vecs,
                 bool solves)
{
    const struct pcg *p = &s->solver.pcg;
    bool wind = solves && s->dynamics.windy;
    char *from = solves ? (char *)p->low : (char *)p->factor;
    vec *to = s->dynamics.work + (vecs - wind) * p->count;
    gpu_lend(g, from, (size_t)((char *)to - from));
}

static void take_solver(struct gpu *g, struct sheet *s, int64_t vecs,
                        bool solves)
{
    struct pcg *p = &s->solver.pcg;
    char *block = NULL;
    GPU_TAKE_COPY(g, p->chunk, ARENA_SOLVER, NULL, p->n_chunks);
    GPU_TAKE_COPY(g, p->grid.dense, ARENA_SOLVER, NULL, p->grid.n_dense);
    GPU_TAKE_COPY(g, block, ARENA_SOLVER, NULL,
                  (int64_t)lay_out(s, vecs, NULL).at);
    if (!block)
        return;
    lay_out(s, vecs, block);
    p->q = p->p + p->count;
    s->dynamics.work = p->q + p->count;
    lend(g, s, vecs, solves);
}

void gpu_sheet_make(struct gpu_world *d, int k)
{
    struct gpu *g = d->gpu;
    const struct sheet *h = &d->host->sheet[k];
    struct sheet *s = &d->world.sheet[k];
    struct gpu_sheet *more = s->device;
    struct cloth *c = &s->cloth;
    struct dynamics *m = &s->dynamics;
    struct pcg *p = &s->solver.pcg;
    *s = *h;
    s->device = more;
    c->tri = NULL;
    GPU_TAKE_COPY(g, c->cell, ARENA_CLOTH, h->cloth.cell, c->count);
    GPU_TAKE_COPY(g, c->springs, ARENA_CLOTH, h->cloth.springs, c->count);
    GPU_TAKE_COPY(g, c->beside, ARENA_CLOTH, h->cloth.beside, c->count);
    GPU_TAKE_COPY(g, c->fixed, ARENA_CLOTH, h->cloth.fixed, c->count);
    GPU_TAKE_COPY(g, c->mass, ARENA_CLOTH, h->cloth.mass, c->count);
    if (c->panel) {
        c->panel = gpu_panel_make(g, h->cloth.panel);
        GPU_TAKE_COPY(g, c->pairs, ARENA_CLOTH, h->cloth.pairs, c->count);
    }
    GPU_TAKE_COPY(g, more->law, ARENA_CLOTH, c->law, SPRINGS);
    GPU_TAKE_COPY(g, more->piece, ARENA_CLOTH, c->piece, PIECES);
    GPU_TAKE_COPY(g, more->triple, ARENA_CLOTH, c->triple, TRIPLES);
    GPU_TAKE_COPY(g, s->pinned, ARENA_CLOTH, h->pinned, h->pins.n);
    gpu_kinematics_make(g, ARENA_CLOTH, &h->pins, d->world.posed, &s->pins);
    GPU_TAKE_COPY(g, s->pins.x, ARENA_CLOTH, h->pins.x, h->pins.n);
    m->cloth = c;
    m->solver = s;
    int64_t vecs = motion_vecs(m);
    GPU_TAKE_COPY(g, m->chunk, ARENA_SOLVER, NULL, 3 * sum_chunks(c->count));
    if (!dynamics_implicit(m->method)) {
        GPU_TAKE_COPY(g, m->work, ARENA_SOLVER, NULL,
                      (vecs + motion_spares(m)) * c->count);
        return;
    }
    more->star = d->star + s->first;
    more->b = d->b + s->first;
    GPU_TAKE_COPY(g, m->block, ARENA_SOLVER, NULL, SPRINGS * c->count);
    if (m->newton > 1)
        GPU_TAKE_COPY(g, m->kept, ARENA_SOLVER, NULL, 2 * c->count);
    if (p->n_packed)
        GPU_TAKE_COPY(g, m->packed, ARENA_SOLVER, NULL, p->n_packed);
    if (gpu_rates_help(g, p))
        GPU_TAKE_COPY(g, more->rate, ARENA_SOLVER, NULL, SPRINGS * c->count);
    p->mass = c->mass;
    p->fixed = c->fixed;
    take_solver(g, s, vecs, d->world.plan.solves);
}
