/* SPDX-License-Identifier: Apache-2.0 */
/* Decides whether the state at the end of a step intersects. The audit counts
 * the pairs after a step whose response could not part a pair, and then after
 * each step until no pair is left. spec/world/step.md §11 */
#include "ref/world/ending.h"

#include "ref/seam/seam.h"

static void *take_array(struct world *w, void *had, int64_t n, size_t size)
{
    return had ? had : w->run->take(w->on, ARENA_RESPONSE, n, size);
}

/* Takes the streams that have not been taken yet. Some may have been taken by
 * an earlier call that then ran out of memory. */
static int take_streams(struct world *w)
{
    struct audit *s = &w->ending;
    s->n_nodes = ref_audit_nodes(w->nt);
    for (int k = 0; k < 2; k++) {
        s->key[k] = take_array(w, s->key[k], w->nt, sizeof **s->key);
        s->order[k] = take_array(w, s->order[k], w->nt, sizeof **s->order);
    }
    s->node = take_array(w, s->node, s->n_nodes, sizeof *s->node);
    s->degenerate = take_array(w, s->degenerate, w->nt, 1);
    s->group = take_array(w, (void *)s->group, w->nt, sizeof *s->group);
    int status = w->run->status(w->on);
    if (status != DRAPE_OK)
        return status;
    return w->run->ending_streams(w->on, s, w->nt, w->ntc);
}

/* Lists the pairs, and counts those that a seam joins. */
static int divide_pairs(struct world *w, struct audit *s)
{
    int status = w->run->audit(w->on, s);
    if (status == DRAPE_EFULL) {
        w->run->give(w->on, s->pair);
        s->cap = s->found;
        s->pair = w->run->take(w->on, ARENA_RESPONSE, s->cap, sizeof *s->pair);
        status = s->pair ? w->run->audit(w->on, s) : DRAPE_ENOMEM;
    }
    int32_t(*pair)[2] =
        arena_take(w->arena, ARENA_OTHER, s->found, sizeof *pair);
    if (!pair)
        status = DRAPE_ENOMEM;
    if (status == DRAPE_OK) {
        w->run->fetch(w->on, pair, s->pair, (size_t)s->found * sizeof *pair);
        status = w->run->status(w->on);
    }
    for (int64_t k = 0; k < s->found && status == DRAPE_OK; k++)
        w->sewn += sew_joins(w, pair[k][0], pair[k][1]);
    arena_give(w->arena, pair);
    if (status != DRAPE_OK)
        s->cap = s->pair ? s->cap : 0;
    return status;
}

int ending_count(struct world *w, const vec *x, int64_t *found)
{
    struct audit *s = &w->ending;
    int status = take_streams(w);
    if (status != DRAPE_OK)
        return status;
    s->nv = w->nv;
    s->nt = w->nt;
    s->x = x;
    s->tri = (const int32_t(*)[3])w->tri;
    s->across = !w->plan.self;
    w->sewn = 0;
    if (w->seams.n > 0) {
        status = divide_pairs(w, s);
        *found = s->found - w->sewn;
        return status;
    }
    s->cap = 0; /* only the number of pairs is needed, not the pairs */
    status = w->run->audit(w->on, s);
    *found = s->found;
    return status == DRAPE_EFULL ? DRAPE_OK : status;
}

void ending_tell(const struct world *w, drape_step_report *r)
{
    if (w->intersecting > 0)
        r->outcome |= DRAPE_TRAPPED;
    else if (r->outcome & DRAPE_TRAPPED)
        r->outcome ^= DRAPE_TRAPPED | DRAPE_PASSED;
    r->intersecting = w->intersecting;
    r->sewn = w->sewn;
}
