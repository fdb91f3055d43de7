/* SPDX-License-Identifier: Apache-2.0 */
/* Contacts within the implicit solve of every cloth, on the device: memory, and
 * ref/contact/turn.h. spec/contact/penalty.md §4 */
#include "gpu/base/real.cuh"
#include "gpu/run/gpu.cuh"

/* g, b and dv are the motion's star, b and dv, which that does not read any
 * more; b is penalty's force at first. */
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
    p->g = c->g = w->star;
    p->hold = (sym *)gpu_take(g, ARENA_RESPONSE, nv, sizeof(sym));
    p->guess = (vec *)gpu_borrow(g, ARENA_RESPONSE, nv, sizeof(vec));
    c->press = p->guess; /* of the last contacts: no solve is after */
    p->parts = (real *)gpu_borrow(g, ARENA_RESPONSE, nv, sizeof(real));
    return gpu_status(g);
}

/* The lists are warm's, too; the rest is penalty's alone, in the pools of stage
 * contacts, which comes later. */
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
    p->gave = (real *)s->push.data;
    if (status != DRAPE_OK || n <= c->cap)
        return status;
    gpu_give(g, p->item);
    int64_t cap = n + n / 4 + 64;
    p->item = (int32_t *)gpu_take(g, ARENA_RESPONSE, 4 * cap, sizeof(int32_t));
    c->cap = p->item ? cap : 0;
    return gpu_status(g);
}

/* Thread i owns particle i: g begins with what presses already. */
static __global__ void __launch_bounds__(GPU_BLOCK)
    turn_begin_kernel(vec *g, const vec *press, real dt, int64_t n)
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
static __global__ void __launch_bounds__(GPU_BLOCK)
    turn_carry_kernel(struct turn s)
{
    ITEM(i, s.count);
    s.g[i] = sub(s.g[i], s.r[i]);
}

void gpu_turn_carry(struct gpu *g, const struct turn *s)
{
    LAUNCH(g, s->count, turn_carry_kernel, *s);
}

/* Thread i owns particle i: b = force - g, 0 where fixed. */
static __global__ void __launch_bounds__(GPU_BLOCK)
    turn_load_kernel(struct turn s)
{
    ITEM(i, s.count);
    s.b[i] = s.fixed[i] ? make(0, 0, 0) : sub(s.force[i], s.g[i]);
}

void gpu_turn_load(struct gpu *g, const struct turn *s)
{
    LAUNCH(g, s->count, turn_load_kernel, *s);
}

/* Thread i owns particle i: g gains A dv, whatever pcg left over; u, v, x1
 * move with dv. */
static __global__ void __launch_bounds__(GPU_BLOCK)
    turn_move_kernel(struct turn s)
{
    ITEM(i, s.count);
    if (s.fixed[i])
        return;
    vec dv = s.dv[i];
    vec done = sub(sub(s.b[i], s.r[i]), apply(s.hold[i], dv));
    vec u = axpy(s.u[i], s.span, dv);
    s.g[i] = add(s.g[i], done);
    s.u[i] = u;
    s.v[i] = add(s.v[i], dv);
    s.x1[i] = axpy(s.x0[i], s.dt, u);
    s.touched[i] = 1;
}

void gpu_turn_move(struct gpu *g, const struct turn *s)
{
    LAUNCH(g, s->count, turn_move_kernel, *s);
}
