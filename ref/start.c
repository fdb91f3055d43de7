/* SPDX-License-Identifier: Apache-2.0 */
/* Whether a scene may start as it is. */
#include "ref/start.h"

#include <stdio.h>

#include "ref/audit.h"

static void *take(struct world *w, int64_t n, size_t size)
{
    return arena_take(w->arena, ARENA_OTHER, n, size);
}

static int take_audit(struct world *w, struct audit *s)
{
    int32_t *group = take(w, w->nt, sizeof *group);
    s->n_nodes = ref_audit_nodes(s->nt);
    for (int k = 0; k < 2; k++) {
        s->key[k] = take(w, s->nt, sizeof **s->key);
        s->order[k] = take(w, s->nt, sizeof **s->order);
    }
    s->node = take(w, s->n_nodes, sizeof *s->node);
    s->count = take(w, s->n_nodes, sizeof *s->count);
    s->degenerate = take(w, s->nt, 1);
    s->pair = take(w, s->cap, sizeof *s->pair);
    s->group = group;
    for (int64_t k = 0; k < w->nt && group; k++)
        group[k] = k < w->ntc;
    return w->arena->failed ? DRAPE_ENOMEM : DRAPE_OK;
}

static void give_audit(struct world *w, struct audit *s)
{
    for (int k = 0; k < 2; k++) {
        arena_give(w->arena, s->key[k]);
        arena_give(w->arena, s->order[k]);
    }
    arena_give(w->arena, s->node);
    arena_give(w->arena, s->count);
    arena_give(w->arena, s->degenerate);
    arena_give(w->arena, s->pair);
    arena_give(w->arena, (void *)s->group);
}

int start_audit(struct world *w, drape_error *error)
{
    struct audit s = {.nv = w->nv, .nt = w->nt, .x = w->x0, .cap = 1024};
    s.across = !w->plan.self;
    s.tri = (const int32_t(*)[3])w->tri;
    int status = take_audit(w, &s);
    if (status == DRAPE_OK)
        status = ref_audit(&s);
    if (status == DRAPE_EFULL) {
        arena_give(w->arena, s.pair);
        s.cap = s.found;
        s.pair = take(w, s.cap, sizeof *s.pair);
        status = s.pair ? ref_audit(&s) : DRAPE_ENOMEM;
    }
    w->intersecting = status == DRAPE_OK ? s.found : 0;
    give_audit(w, &s);
    if (!w->intersecting || w->def.allow_intersecting)
        return status;
    if (error)
        snprintf(error->text, sizeof error->text,
                 "the start state has %lld intersecting triangle pairs",
                 (long long)w->intersecting);
    return DRAPE_ESTART;
}
