/* SPDX-License-Identifier: Apache-2.0 */
/* Connects the stages that a scene uses to its streams and settings. */
#include "ref/world/connect.h"

#include "ref/base/packed.h"
#include "ref/base/sum.h"
#include "ref/contact/unknowns.h"
#include "ref/world/collide.h"

static void *take_stream(struct world *w, enum arena_part part, int64_t n,
                         size_t size)
{
    return arena_take(w->arena, part, n, size);
}

static int make_dynamics(struct world *w, struct sheet *s, const drape_def *def)
{
    struct dynamics *d = &s->dynamics;
    const struct cloth *c = &s->cloth;
    d->cloth = c;
    d->method = def->integrator;
    d->max_substeps = def->max_substeps;
    d->newton = w->plan.newton;
    d->gravity = vec_make((real)def->gravity[0], (real)def->gravity[1],
                          (real)def->gravity[2]);
    d->trace = w->tracing;
    if (w->def.backend != DRAPE_REF) {
        solver_size(&s->solver.pcg, def, c);
        return DRAPE_OK; /* the device has the streams */
    }
    d->work = take_stream(w, ARENA_SOLVER, dynamics_vecs(d->method) * c->count,
                          sizeof *d->work);
    d->chunk = take_stream(w, ARENA_SOLVER, 3 * sum_chunks(c->count),
                           sizeof *d->chunk);
    if (w->arena->failed)
        return DRAPE_ENOMEM;
    if (!w->plan.implicit)
        return DRAPE_OK;
    int64_t springs = SPRINGS * c->count;
    d->block = take_stream(w, ARENA_SOLVER, springs, sizeof *d->block);
    if (def->precond == DRAPE_MULTIGRID && !c->panel)
        d->packed = take_stream(w, ARENA_SOLVER, springs, sizeof *d->packed);
    if (d->newton > 1)
        d->kept = take_stream(w, ARENA_SOLVER, 2 * c->count, sizeof *d->kept);
    d->solve = solver_solve;
    d->solver = &s->solver;
    return !w->arena->failed ? solver_make(&s->solver, def, c, w->arena)
                             : DRAPE_ENOMEM;
}

static int make_broad(struct world *w, const drape_def *def)
{
    int bodies = def->n_cloths + def->n_obstacles;
    struct tree_mesh *mesh = take_stream(w, ARENA_TREE, bodies, sizeof *mesh);
    if (!mesh)
        return DRAPE_ENOMEM;
    for (int k = 0; k < bodies; k++) {
        bool grid = k < def->n_cloths;
        int64_t first = state_first_triangle(w, k);
        mesh[k].first_tri = (int32_t)first;
        mesh[k].tris = (int32_t)(state_first_triangle(w, k + 1) - first);
        if (grid) {
            mesh[k].kind = TREE_CLOTH;
            mesh[k].base = (int32_t)w->sheet[k].first;
            mesh[k].m = w->sheet[k].cloth.m;
            mesh[k].n = w->sheet[k].cloth.n;
            mesh[k].self = def->self_collision;
            mesh[k].size = w->sheet[k].size;
        } else
            mesh[k].kind =
                w->prop[k - def->n_cloths].moves ? TREE_MOVING : TREE_STATIC;
    }
    struct tree_scene scene = {bodies,
                               (int32_t)w->nv,
                               (int32_t)w->nt,
                               mesh,
                               (const int32_t(*)[3])w->tri,
                               w->x0};
    int status = broad_make(&w->broad, &scene, def->self_collision, w->arena);
    w->broad.trace = w->tracing;
    w->broad.n_start = w->seams.n_start;
    w->broad.n_sewn = w->seams.n_sewn;
    w->broad.start = w->seams.start;
    w->broad.sewn = w->seams.sewn;
    return status;
}

static int make_response(struct world *w, const drape_def *def)
{
    struct response *c = &w->response;
    c->nv = w->nv;
    c->trace = w->tracing;
    c->w = w->w;
    c->surfaces.n = def->n_cloths + def->n_obstacles;
    c->surfaces.of = w->body;
    c->surfaces.surface = w->surface;
    c->one_rings = w->broad.tree.one_rings;
    for (int k = 0; k < def->n_cloths; k++)
        c->stiffness =
            real_max(c->stiffness,
                     RESPONSE_SOFT * (real)def->cloths[k].material.stretch);
    c->margin = R(0.125);
    c->iterations = 8;
    c->max_rounds = def->max_rounds;
    c->zone_rounds = 4;
    c->roll_rounds = 16;
    c->run = w->run;
    c->on = w->on;
    c->broad = collide_broad;
    c->user = w;
    if (w->def.backend != DRAPE_REF)
        return DRAPE_OK; /* the device has the streams */
    c->u = take_stream(w, ARENA_RESPONSE, w->nv, sizeof *c->u);
    c->touched = take_stream(w, ARENA_RESPONSE, w->nv, 1);
    c->rolled = take_stream(w, ARENA_RESPONSE, w->nv, 1);
    c->start = take_stream(w, ARENA_RESPONSE, w->nv + 1, sizeof *c->start);
    c->first = take_stream(w, ARENA_RESPONSE, w->nv, sizeof *c->first);
    if (w->arena->failed)
        return DRAPE_ENOMEM;
    return w->plan.solves ? unknowns_make(w) : DRAPE_OK;
}

int connect_stages(struct world *w, const drape_def *def)
{
    int status = DRAPE_OK;
    for (int k = 0; k < def->n_cloths && status == DRAPE_OK; k++)
        status = make_dynamics(w, &w->sheet[k], def);
    if (status == DRAPE_OK && w->plan.collides)
        status = make_broad(w, def);
    if (status == DRAPE_OK && w->plan.collides)
        status = make_response(w, def);
    return status;
}
