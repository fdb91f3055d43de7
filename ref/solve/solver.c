/* SPDX-License-Identifier: Apache-2.0 */
/* The linear system of one cloth: stage pcg with its memory and a clock. */
#include "ref/solve/solver.h"

#include "ref/base/clock.h"
#include "ref/base/packed.h"
#include "ref/cloth/cloth.h"
#include "ref/cloth/dynamics.h"
#include "ref/solve/matrix.h"
#include "ref/solve/sewn.h"

static void *take_stream(struct arena *a, int64_t n, size_t size)
{
    return arena_take(a, ARENA_SOLVER, n, size);
}

void solver_size(struct pcg *p, const drape_def *def, const struct cloth *cloth)
{
    p->m = cloth->m;
    p->n = cloth->n;
    p->count = cloth->count;
    p->precond = def->precond;
    p->form = def->matrix;
    p->solver = def->solver;
    p->tolerance = (real)def->tolerance;
    p->max_iterations = def->max_iterations;
    p->mass = cloth->mass;
    p->fixed = cloth->fixed;
    p->triples = cloth->triples > 0;
    p->whole = cloth->panel != NULL;
    p->depth = sewn_depth(def);
    ref_pcg_size(p);
}

int solver_make(struct solver *s, const drape_def *def,
                const struct cloth *cloth, struct arena *arena)
{
    struct pcg *p = &s->pcg;
    solver_size(p, def, cloth);
    p->cdf = take_stream(arena, p->n_cdf, sizeof *p->cdf);
    p->diagonal =
        take_stream(arena, p->n_cdf ? p->count : 0, sizeof *p->diagonal);
    p->factor = take_stream(arena, p->count, sizeof *p->factor);
    p->low = take_stream(arena, p->count, sizeof *p->low);
    p->r = take_stream(arena, p->count, sizeof *p->r);
    p->s = take_stream(arena, p->count, sizeof *p->s);
    p->p = take_stream(arena, p->count, sizeof *p->p);
    p->q = take_stream(arena, p->count, sizeof *p->q);
    p->chunk = take_stream(arena, p->n_chunks, sizeof *p->chunk);
    p->grid.parts = take_stream(arena, p->grid.n_parts, sizeof *p->grid.parts);
    p->grid.pool = take_stream(arena, p->grid.n_pool, sizeof *p->grid.pool);
    p->grid.room = take_stream(arena, p->grid.n_room, sizeof *p->grid.room);
    p->grid.live = take_stream(arena, p->grid.n_live, sizeof *p->grid.live);
    p->grid.dense = take_stream(arena, p->grid.n_dense, sizeof *p->grid.dense);
    return arena->failed ? DRAPE_ENOMEM : DRAPE_OK;
}

int solver_solve(struct dynamics *d)
{
    struct solver *s = d->solver;
    double start = clock_now();
    s->pcg.block = d->block;
    s->pcg.packed = d->packed;
    s->pcg.b = d->b;
    s->pcg.dv = d->dv;
    if (d->asked > 0)
        s->pcg.tolerance = d->asked;
    int status = ref_pcg(&s->pcg);
    d->iterations += s->pcg.iterations;
    d->residual = (double)s->pcg.residual;
    if (status == DRAPE_OK && s->pcg.outcome != PCG_CONVERGED)
        d->outcome |= DRAPE_UNCONVERGED;
    s->seconds += clock_now() - start;
    return status;
}
