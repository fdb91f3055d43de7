/* SPDX-License-Identifier: Apache-2.0 */
/* What a step that fails in a later slice goes back to: its start. Taken when
 * a step is first cut. spec/world/step.md §7 */
#include "ref/world/slice.h"
#include "ref/world/state.h"

static vec *take(struct world *w, vec *had, int64_t n)
{
    return had ? had : arena_take(w->arena, ARENA_STATE, n, sizeof *had);
}

/* What is not there yet; a try before may have got a part of it. */
static int take_start(struct world *w)
{
    struct start *s = &w->start;
    s->x = take(w, s->x, w->nv);
    s->v = take(w, s->v, w->nv);
    if (w->past_x) {
        s->past_x = take(w, s->past_x, w->nc);
        s->past_v = take(w, s->past_v, w->nc);
    }
    if (w->press)
        s->press = take(w, s->press, w->nc);
    if (!s->watch)
        s->watch = arena_take(w->arena, ARENA_STATE, w->def.n_cloths,
                              sizeof *s->watch);
    return w->arena->failed ? DRAPE_ENOMEM : DRAPE_OK;
}

int slice_save(struct world *w)
{
    struct start *s = &w->start;
    size_t n = (size_t)w->nv * sizeof(vec);
    size_t past = w->past_x ? (size_t)w->nc * sizeof(vec) : 0;
    if (take_start(w) != DRAPE_OK)
        return DRAPE_ENOMEM;
    memcpy(s->x, w->x0, n);
    memcpy(s->v, w->v0, n);
    if (past) {
        memcpy(s->past_x, w->past_x, past);
        memcpy(s->past_v, w->past_v, past);
    }
    if (w->press)
        memcpy(s->press, w->press, (size_t)w->nc * sizeof(vec));
    memcpy(s->watch, w->watch, (size_t)w->def.n_cloths * sizeof *s->watch);
    s->pressed = w->pressed;
    s->past = w->past;
    s->resting = w->resting;
    s->asleep = w->asleep;
    s->near = w->near;
    return DRAPE_OK;
}

void slice_restore(struct world *w)
{
    const struct start *s = &w->start;
    size_t past = w->past_x ? (size_t)w->nc * sizeof(vec) : 0;
    memcpy(w->x0, s->x, (size_t)w->nv * sizeof(vec));
    memcpy(w->v0, s->v, (size_t)w->nv * sizeof(vec));
    if (past) {
        memcpy(w->past_x, s->past_x, past);
        memcpy(w->past_v, s->past_v, past);
    }
    if (w->press)
        memcpy(w->press, s->press, (size_t)w->nc * sizeof(vec));
    memcpy(w->watch, s->watch, (size_t)w->def.n_cloths * sizeof *s->watch);
    w->pressed = s->pressed;
    w->past = s->past;
    w->resting = s->resting;
    w->asleep = s->asleep;
    w->near = s->near;
}
