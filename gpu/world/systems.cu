/* SPDX-License-Identifier: Apache-2.0 */
/* Gathers the systems of a world's cloths for the joint solve, and takes the
 * memory of the motion with contacts. spec/contact/lagrange.md §3.2 */
extern "C" {
#include "gpu/cloth/sheet.h"
#include "gpu/contact/joint.h"
#include "gpu/contact/queue.h"
#include "gpu/run/backend.h"
#include "gpu/solve/sewn.h"
#include "gpu/world/state.h"
#include "gpu/world/systems.h"
#include "ref/base/sum.h"
#include "ref/sleep/rest.h"
}

int gpu_systems_make(struct gpu_world *w)
{
    w->part = (struct joint_part *)arena_take(
        w->world.arena, ARENA_OTHER, w->world.def.n_cloths, sizeof *w->part);
    return w->part ? DRAPE_OK : DRAPE_ENOMEM;
}

template <class T> static void take(struct gpu *g, T **p, int64_t n)
{
    *p = (T *)gpu_take(g, ARENA_RESPONSE, n, sizeof **p);
}

/* The streams of the joint solve. Directions are 0 beyond the cloths. */
static void make_joint(struct gpu_world *w, struct joint *s)
{
    struct gpu *g = w->gpu;
    int64_t nv = w->world.nv, nc = w->world.nc;
    s->nc = nc;
    take(g, &s->r, nv);
    take(g, &s->q, nv);
    take(g, &s->p, nv);
    take(g, &s->p2, nv);
    take(g, &s->dv, nv);
    take(g, &s->item, nc);
    s->n_chunks = sum_chunks(nc);
    take(g, &s->chunk, 3 * s->n_chunks);
    take(g, &w->links, 1);
    take(g, &w->mutual_end, nc);
}

/* rest is the motions' own b: what they write there is what they lack. */
int gpu_systems_streams(struct gpu_world *w)
{
    struct gpu *g = w->gpu;
    struct lagrange *a = &w->world.lagrange;
    struct coulomb *s = &a->law;
    int64_t nv = w->world.nv, nc = w->world.nc;
    s->nv = nv;
    s->nc = nc;
    s->nv1 = nv + 1;
    s->w = w->world.w;
    s->u = w->world.response.u;
    s->start = w->world.response.start;
    take(g, &s->force, nv);
    take(g, &s->inner, nc);
    take(g, &s->outer, nc);
    take(g, &s->single, nv);
    a->rest = w->b;
    for (int k = 0; k < 2; k++)
        take(g, &a->bound[k], nv);
    if (w->world.plan.history) {
        take(g, &a->jump, nc);
        take(g, &a->bare, nv);
        take(g, &a->none, nv + 1);
    }
    make_joint(w, &a->joint);
    const struct sewn *grids = w->host->seams.grids;
    if (grids)
        w->world.seams.grids = gpu_sewn_make(g, w->world.arena, grids);
    return grids && !w->world.seams.grids ? DRAPE_ENOMEM : gpu_status(g);
}

/* The lists are read until the slice ends, and vertex and next by stage coulomb
 * alone; so those two are in pools of stage contacts, which comes later. */
int gpu_unknowns_room(struct world *w, int64_t n)
{
    struct lagrange *a = &w->lagrange;
    struct coulomb *s = &a->law;
    struct links *links = &a->joint.links;
    struct gpu_world *d = w->device;
    struct gpu *g = d->gpu;
    struct pool_need need[] = {{&w->response.vertex, 4 * n, sizeof *s->vertex},
                               {&w->response.push, n, sizeof *s->next}};
    int status = response_grow(&w->response, 2, need);
    s->vertex = (int32_t *)w->response.vertex.data;
    s->next = (vec *)w->response.push.data;
    if (status != DRAPE_OK || n <= a->cap)
        return status;
    gpu_give(g, s->item);
    gpu_give(g, links->push);
    gpu_give(g, d->mutual);
    int64_t cap = gpu_capacity(g, n);
    take(g, &s->item, 4 * cap);
    take(g, &links->push, cap);
    take(g, &d->mutual, 4 * cap);
    a->cap = s->item && links->push && d->mutual ? cap : 0;
    return gpu_status(g);
}

/* The systems of the cloths that are awake. */
static struct joint_system systems_of(struct world *w, struct joint *s)
{
    struct gpu_world *d = w->device;
    int n = 0;
    for (int k = 0; k < w->def.n_cloths; k++) {
        const struct sheet *a = &w->sheet[k];
        struct joint_part *p = &d->part[n];
        if (!sleep_awake(w, k))
            continue;
        n++;
        p->pcg = a->solver.pcg;
        p->pcg.block = a->dynamics.block;
        p->pcg.packed = a->dynamics.packed;
        p->rate = a->device->rate;
        p->first = a->first;
        p->cloth = k;
    }
    return (struct joint_system){.gpu = d->gpu,
                                 .n = n,
                                 .part = d->part,
                                 .joint = s,
                                 .links = d->links,
                                 .mutual_end = d->mutual_end,
                                 .mutual = d->mutual,
                                 .w = w->w,
                                 .sewn = w->seams.grids};
}

/* Stage coulomb, before, has left it to this readback to tell that a contact is
 * bad. */
static int checked(const struct world *w, int status)
{
    bool bad = gpu_queue_bad(w->device->gpu);
    return status == DRAPE_OK && bad ? (int)DRAPE_EARG : status;
}

int gpu_joint_set_up(struct world *w, struct joint *s)
{
    const struct joint_system all = systems_of(w, s);
    return gpu_joint_system_set_up(&all);
}

int gpu_joint_measure(struct world *w, struct joint *s, const vec *r,
                      real *value)
{
    const struct joint_system all = systems_of(w, s);
    return checked(w, gpu_joint_system_measure(&all, r, value));
}

int gpu_joint_solve(struct world *w, struct joint *s)
{
    const struct joint_system all = systems_of(w, s);
    return checked(w, gpu_joint_system_solve(&all));
}
