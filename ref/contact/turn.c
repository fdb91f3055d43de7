/* SPDX-License-Identifier: Apache-2.0 */
/* What a turn of contacts and solves computes besides its stages, and its
 * memory. spec/contact/penalty.md §4 */
#include "ref/contact/turn.h"

#include "ref/base/sum.h"
#include "ref/world/state.h"

static void *take(struct world *w, int64_t n, size_t size)
{
    return arena_take(w->arena, ARENA_RESPONSE, n, size);
}

static void make_joint(struct world *w, struct joint *s)
{
    s->r = take(w, w->nv, sizeof *s->r);
    s->q = take(w, w->nv, sizeof *s->q);
    s->p = take(w, w->nv, sizeof *s->p);
    s->dv = take(w, w->nv, sizeof *s->dv);
    s->n_chunks = sum_chunks(w->nc);
    s->chunk = take(w, 3 * s->n_chunks, sizeof *s->chunk);
}

int turn_make(struct world *w)
{
    struct couple *c = &w->couple;
    struct penalty *p = &c->penalty;
    p->nv = w->nv;
    p->nv1 = w->nv + 1;
    p->w = w->w;
    p->u = w->response.u;
    p->stiffness = w->response.stiffness;
    p->start = w->response.start;
    p->force = take(w, w->nv, sizeof *p->force);
    p->hold = take(w, w->nv, sizeof *p->hold);
    p->wall = take(w, w->nv, sizeof *p->wall);
    p->guess = take(w, w->nv, sizeof *p->guess);
    c->press = p->guess; /* which nobody reads between two penalties */
    p->parts = take(w, w->nv, sizeof *p->parts);
    p->more = take(w, w->nv, sizeof *p->more);
    c->g = take(w, w->nc, sizeof *c->g);
    p->g = c->given = take(w, w->nc, sizeof *c->given);
    c->b = take(w, w->nc, sizeof *c->b);
    for (int k = 0; k < COUPLE_ENDS; k++)
        c->found[k] = take(w, w->nc, sizeof *c->found[k]);
    make_joint(w, &c->joint);
    return w->arena->failed ? DRAPE_ENOMEM : DRAPE_OK;
}

int turn_room(struct world *w, int64_t n)
{
    struct couple *c = &w->couple;
    struct penalty *p = &c->penalty;
    if (n <= c->cap)
        return DRAPE_OK;
    arena_give(w->arena, p->item);
    arena_give(w->arena, p->vertex);
    arena_give(w->arena, p->share);
    arena_give(w->arena, p->gave);
    arena_give(w->arena, p->rub);
    arena_give(w->arena, c->joint.links.push);
    int64_t cap = n + n / 4 + 64;
    p->item = take(w, 4 * cap, sizeof *p->item);
    p->vertex = take(w, 4 * cap, sizeof *p->vertex);
    p->share = take(w, cap, sizeof *p->share);
    p->gave = take(w, cap, sizeof *p->gave);
    p->rub = take(w, 4 * cap, sizeof *p->rub);
    c->joint.links.push = take(w, cap, sizeof(vec));
    c->cap = w->arena->failed ? 0 : cap;
    return w->arena->failed ? DRAPE_ENOMEM : DRAPE_OK;
}

void turn_begin(int64_t n, vec *g, const vec *press, real dt)
{
    EACH_ITEM
    for (int64_t i = 0; i < n; i++)
        g[i] = press ? vec_scale(dt, press[i]) : vec_make(0, 0, 0);
}

void turn_carry(int64_t n, const vec *r, vec *g)
{
    EACH_ITEM
    for (int64_t i = 0; i < n; i++)
        g[i] = vec_sub(g[i], r[i]);
}

void turn_load(const struct turn *s)
{
    EACH_ITEM
    for (int64_t i = 0; i < s->count; i++) {
        vec b = vec_sub(s->force[i], s->g[i]);
        s->b[i] = s->w[i] > 0 ? b : vec_make(0, 0, 0);
    }
}

void turn_move(const struct turn *s)
{
    EACH_ITEM
    for (int64_t i = 0; i < s->count; i++) {
        if (!(s->w[i] > 0))
            continue;
        vec g = s->moves ? vec_add(s->g[i], s->q[i]) : s->g[i];
        s->given[i] = vec_add(g, s->r[i]);
        if (!s->moves)
            continue;
        vec dv = s->dv[i];
        s->g[i] = g;
        s->u[i] = vec_axpy(s->u[i], s->span, dv);
        s->v[i] = vec_add(s->v[i], dv);
        s->x1[i] = vec_axpy(s->x0[i], s->dt, s->u[i]);
        s->touched[i] = 1;
    }
}
