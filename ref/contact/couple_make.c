/* SPDX-License-Identifier: Apache-2.0 */
/* The memory of contacts within the implicit solve, of the reference.
 * spec/contact/penalty.md §4 */
#include "ref/contact/couple.h"
#include "ref/world/state.h"

static void *take(struct world *w, int64_t n, size_t size)
{
    return arena_take(w->arena, ARENA_RESPONSE, n, size);
}

int couple_make(struct world *w)
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
    p->guess = take(w, w->nv, sizeof *p->guess);
    c->press = p->guess; /* which nobody reads between two penalties */
    p->brake = take(w, w->nv, sizeof *p->brake);
    c->g = take(w, w->nc, sizeof *c->g);
    p->g = c->g;
    c->b = take(w, w->nc, sizeof *c->b);
    c->dv = take(w, w->nc, sizeof *c->dv);
    return w->arena->failed ? DRAPE_ENOMEM : DRAPE_OK;
}

int couple_room(struct world *w, int64_t n)
{
    struct couple *c = &w->couple;
    struct penalty *p = &c->penalty;
    if (n <= c->cap)
        return DRAPE_OK;
    arena_give(w->arena, p->item);
    arena_give(w->arena, p->vertex);
    arena_give(w->arena, p->share);
    arena_give(w->arena, p->gave);
    arena_give(w->arena, p->most);
    arena_give(w->arena, p->more);
    int64_t cap = n + n / 4 + 64;
    p->item = take(w, 4 * cap, sizeof *p->item);
    p->vertex = take(w, 4 * cap, sizeof *p->vertex);
    p->share = take(w, cap, sizeof *p->share);
    p->gave = take(w, cap, sizeof *p->gave);
    p->most = take(w, cap, sizeof *p->most);
    p->more = take(w, cap, sizeof *p->more);
    c->cap = w->arena->failed ? 0 : cap;
    return w->arena->failed ? DRAPE_ENOMEM : DRAPE_OK;
}
