/* SPDX-License-Identifier: Apache-2.0 */
/* The unknowns of a slice with contacts on the device: memory, and
 * ref/contact/unknowns.h. spec/contact/lagrange.md */
#include "gpu/contact/contact.cuh"
#include "gpu/contact/lists.cuh"

extern "C" {
#include "gpu/contact/joint.h"
#include "gpu/contact/unknowns.h"
#include "gpu/world/state.h"
#include "ref/base/sum.h"
#include "ref/contact/unknowns.h"
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
int gpu_unknowns_make(struct gpu_world *w)
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
    take(g, &s->wall, nv);
    a->rest = w->b;
    for (int k = 0; k < 2; k++)
        take(g, &a->hold[k], nv);
    if (w->world.plan.history) {
        take(g, &a->jump, nc);
        take(g, &a->bare, nv);
        take(g, &a->none, nv + 1);
    }
    make_joint(w, &a->joint);
    return gpu_status(g);
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

/* Thread i owns particle i. */
KERNEL unknowns_shift_kernel(const struct shift &s)
{
    ITEM(i, s.count);
    if (!(s.w[i] > 0))
        return;
    vec dv = s.dv[i], u = axpy(s.u[i], s.span * s.part, dv);
    s.u[i] = u;
    s.v[i] = axpy(s.v[i], s.part, dv);
    s.x1[i] = axpy(s.x0[i], s.dt, u);
    s.touched[i] = 1;
}

void gpu_unknowns_shift(struct gpu *g, const struct shift *s)
{
    LAUNCH(g, s->count, unknowns_shift_kernel, *s);
}

/* The impulses of the contacts of a vertex that struck it. */
struct unknowns_struck {
    struct jumps s;
    const int32_t *start;
    __device__ int32_t end(int64_t i) const { return start[i + 1]; }
    __device__ vec value(int32_t at) const
    {
        int32_t item = s.item[at];
        const struct contact *c = &s.contact[item / 4];
        bool struck = c->impulse > 0 && s.kept[item / 4].lambda == 0;
        vec push = axpy(c->tangent, c->impulse, c->n);
        return struck ? scale(c->c[item % 4], push) : make(0, 0, 0);
    }
    __device__ vec first(int64_t) const { return make(0, 0, 0); }
    __device__ void done(int64_t i, vec sum) const
    {
        s.push[i] = s.w[i] > 0 ? sum : make(0, 0, 0);
    }
};

/* Thread i owns particle i. */
KERNEL unknowns_jump_kernel(const struct jumps &s)
{
    sum_list(unknowns_struck{s, s.start}, own_list(s.count));
}

void gpu_unknowns_jump(struct gpu *g, const struct jumps *s)
{
    LAUNCH_LISTS(g, s->count, unknowns_jump_kernel, *s);
}

/* Thread k owns coordinate k of 3 n. */
KERNEL unknowns_lessen_kernel(int64_t n, real part, const real *q, real *r)
{
    ITEM(k, n);
    r[k] = r[k] + -part * q[k];
}

void gpu_unknowns_lessen(struct gpu *g, int64_t n, real part, const vec *q,
                         vec *r)
{
    LAUNCH(g, 3 * n, unknowns_lessen_kernel, 3 * n, part, &q->x, &r->x);
}
