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

/* Where cloth does not see cloth, such pairs are left out. */
static int64_t count(const struct world *w, const struct audit *s)
{
    int64_t n = 0;
    for (int64_t k = 0; k < s->found; k++)
        n += w->plan.self || s->pair[k][0] >= w->ntc || s->pair[k][1] >= w->ntc;
    return n;
}

int start_audit(struct world *w, drape_error *error)
{
    struct audit s = {.nv = w->nv, .nt = w->nt, .x = w->x0, .cap = 1024};
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
    int64_t found = status == DRAPE_OK ? count(w, &s) : 0;
    give_audit(w, &s);
    if (!found)
        return status;
    if (error)
        snprintf(error->text, sizeof error->text,
                 "the start state has %lld intersecting triangle pairs",
                 (long long)found);
    return DRAPE_ESTART;
}
