/* SPDX-License-Identifier: Apache-2.0 */
/* Contacts within the implicit solve of every cloth, on the device: memory, and
 * ref/contact/turn.h. spec/contact/penalty.md §4 */
#include "gpu/base/real.cuh"

extern "C" {
#include "gpu/contact/joint.h"
#include "gpu/contact/turn.h"
#include "gpu/world/state.h"
#include "ref/base/sum.h"
#include "ref/contact/turn.h"
}

/* The streams of the joint solve. Directions are 0 beyond the cloths. */
static void make_joint(struct gpu_world *w, struct joint *s)
{
    struct gpu *g = w->gpu;
    int64_t nv = w->world.nv, nc = w->world.nc;
    size_t bytes = (size_t)nv * sizeof(vec);
    vec **stream[] = {&s->r, &s->q, &s->p, &s->p2, &s->dv};
    for (int k = 0; k < 5; k++) {
        *stream[k] = (vec *)gpu_take(g, ARENA_RESPONSE, nv, sizeof(vec));
        if (*stream[k])
            gpu_clear(g, *stream[k], bytes);
    }
    s->n_chunks = sum_chunks(nc);
    s->item = (real *)gpu_take(g, ARENA_RESPONSE, nc, sizeof(real));
    s->chunk =
        (real *)gpu_take(g, ARENA_RESPONSE, 3 * s->n_chunks, sizeof(real));
    w->links =
        (struct linked *)gpu_take(g, ARENA_RESPONSE, 1, sizeof(struct linked));
    w->mutual_end = (int32_t *)gpu_take(g, ARENA_RESPONSE, nc, sizeof(int32_t));
}

/* g and b are the motion's star and b, which that does not read any more; b is
 * penalty's force at first. */
int gpu_turn_make(struct gpu_world *w)
{
    struct couple *c = &w->world.couple;
    struct penalty *p = &c->penalty;
    int64_t nv = w->world.nv;
    p->nv = nv;
    p->nv1 = nv + 1;
    p->w = w->world.w;
    p->u = w->world.response.u;
    p->stiffness = w->world.response.stiffness;
    p->start = w->world.response.start;
    struct gpu *g = w->gpu;
    p->force = c->b = w->b;
    c->g = w->star;
    p->g = c->given =
        (vec *)gpu_take(g, ARENA_RESPONSE, w->world.nc, sizeof(vec));
    p->hold = (sym *)gpu_take(g, ARENA_RESPONSE, nv, sizeof(sym));
    p->wall = (sym *)gpu_take(g, ARENA_RESPONSE, nv, sizeof(sym));
    p->guess = (vec *)gpu_borrow(g, ARENA_RESPONSE, nv, sizeof(vec));
    c->press = p->guess; /* of the last contacts: no solve is after */
    for (int k = 0; k < COUPLE_ENDS; k++)
        c->found[k] =
            (vec *)gpu_take(g, ARENA_RESPONSE, w->world.nc, sizeof(vec));
    make_joint(w, &c->joint);
    p->parts = (real *)gpu_borrow(g, ARENA_RESPONSE, nv, sizeof(real));
    p->more = (real *)gpu_borrow(g, ARENA_RESPONSE, nv, sizeof(real));
    return gpu_status(g);
}

/* The lists are warm's, too, and gave is read after the slice; the rest is
 * penalty's alone, in the pools of stage contacts, which comes later. */
int gpu_turn_room(struct world *w, int64_t n)
{
    struct couple *c = &w->couple;
    struct penalty *p = &c->penalty;
    struct response *s = &w->response;
    struct gpu *g = w->device->gpu;
    struct pool_need need[] = {{&s->vertex, 4 * n, sizeof(int32_t)},
                               {&s->lack, n, sizeof(real)},
                               {&s->push, 2 * n, sizeof(vec)}};
    int status = response_grow(s, 3, need);
    p->vertex = (int32_t *)s->vertex.data;
    p->share = (real *)s->lack.data;
    p->rub = (real *)s->push.data; /* four numbers in the room of six */
    if (status != DRAPE_OK || n <= c->cap)
        return status;
    gpu_give(g, p->item);
    gpu_give(g, p->gave);
    int64_t cap = gpu_capacity(g, n);
    p->item = (int32_t *)gpu_take(g, ARENA_RESPONSE, 4 * cap, sizeof(int32_t));
    p->gave = (real *)gpu_take(g, ARENA_RESPONSE, cap, sizeof(real));
    struct links *links = &c->joint.links;
    struct mutual **mutual = &w->device->mutual;
    gpu_give(g, links->push);
    gpu_give(g, *mutual);
    links->push = (vec *)gpu_take(g, ARENA_RESPONSE, cap, sizeof(vec));
    *mutual =
        (struct mutual *)gpu_take(g, ARENA_RESPONSE, 4 * cap, sizeof **mutual);
    c->cap = p->item && p->gave && links->push && *mutual ? cap : 0;
    return gpu_status(g);
}

/* Thread i owns particle i: g begins with what presses already. */
KERNEL turn_begin_kernel(vec *g, const vec *press, real dt, int64_t n)
{
    ITEM(i, n);
    g[i] = scale(dt, press[i]);
}

void gpu_turn_begin(struct gpu *g, int64_t n, vec *to, const vec *press,
                    real dt)
{
    if (press)
        LAUNCH(g, n, turn_begin_kernel, to, press, dt, n);
    else
        gpu_clear(g, to, (size_t)n * sizeof *to);
}

/* Thread i owns particle i: what the solve of the free motion left over is the
 * first turn's to do. */
KERNEL turn_carry_kernel(int64_t n, const vec *r, vec *g)
{
    ITEM(i, n);
    g[i] = sub(g[i], r[i]);
}

void gpu_turn_carry(struct gpu *g, int64_t n, const vec *r, vec *to)
{
    LAUNCH(g, n, turn_carry_kernel, n, r, to);
}

/* Thread i owns particle i: b = force - g; 0 where fixed. */
KERNEL turn_load_kernel(const struct turn &s)
{
    ITEM(i, s.count);
    s.b[i] = s.w[i] > 0 ? sub(s.force[i], s.g[i]) : make(0, 0, 0);
}

void gpu_turn_load(struct gpu *g, const struct turn *s)
{
    LAUNCH(g, s->count, turn_load_kernel, *s);
}

/* Thread i owns particle i: given; where the solve moves, g gains A dv, and u,
 * v and x1 move with dv. */
KERNEL turn_move_kernel(const struct turn &s)
{
    ITEM(i, s.count);
    if (!(s.w[i] > 0))
        return;
    vec g = s.moves ? add(s.g[i], s.q[i]) : s.g[i];
    s.given[i] = add(g, s.r[i]);
    if (!s.moves)
        return;
    vec dv = s.dv[i], u = axpy(s.u[i], s.span, dv);
    s.g[i] = g;
    s.u[i] = u;
    s.v[i] = add(s.v[i], dv);
    s.x1[i] = axpy(s.x0[i], s.dt, u);
    s.touched[i] = 1;
}

void gpu_turn_move(struct gpu *g, const struct turn *s)
{
    LAUNCH(g, s->count, turn_move_kernel, *s);
}
