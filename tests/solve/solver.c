/* SPDX-License-Identifier: Apache-2.0 */
/* A struct pcg with memory of its own. */
#include "tests/solve/solver.h"

#include <stdlib.h>

static void *room(int64_t count, size_t size)
{
    return calloc((size_t)count + 1, size);
}

void solver_give(struct pcg *s, const struct system *a)
{
    s->m = a->m;
    s->n = a->n;
    s->mass = a->mass;
    s->n_extra = a->n_extra;
    s->extra = a->extra;
    s->block = a->block;
    s->packed = a->packed;
    s->triples = a->triples;
    s->fixed = a->fixed;
    s->b = a->b;
    ref_pcg_size(s);
}

void solver_open(struct pcg *s, const struct system *a)
{
    solver_give(s, a);
    s->cdf = room(s->n_cdf, sizeof *s->cdf);
    s->diagonal = room(s->count, sizeof *s->diagonal);
    s->factor = room(s->count, sizeof *s->factor);
    s->low = room(s->count, sizeof *s->low);
    s->r = room(s->count, sizeof *s->r);
    s->s = room(s->count, sizeof *s->s);
    s->p = room(s->count, sizeof *s->p);
    s->q = room(s->count, sizeof *s->q);
    s->chunk = room(s->n_chunks, sizeof *s->chunk);
    s->grid.parts = room(s->grid.n_parts, sizeof *s->grid.parts);
    s->grid.pool = room(s->grid.n_pool, sizeof *s->grid.pool);
    s->grid.room = room(s->grid.n_room, sizeof *s->grid.room);
    s->grid.live = room(s->grid.n_live, sizeof *s->grid.live);
    s->grid.dense = room(s->grid.n_dense, sizeof *s->grid.dense);
    s->dv = room(s->count, sizeof *s->dv);
}

void solver_close(struct pcg *s)
{
    void *all[] = {s->cdf,       s->diagonal,  s->factor,    s->r,
                   s->s,         s->p,         s->q,         s->chunk,
                   s->grid.pool, s->grid.room, s->grid.live, s->grid.dense,
                   s->low,       s->dv,        s->grid.parts};
    for (size_t k = 0; k < sizeof all / sizeof *all; k++)
        free(all[k]);
}
