/* SPDX-License-Identifier: Apache-2.0 */
/* Keeps the state at the start of a step, and restores it if the step fails in
 * a later slice or after its last. The memory is taken when a start is first
 * kept. spec/world/step.md §7 */
#include "ref/world/restore.h"
#include "ref/contact/carry.h"
#include "ref/sleep/sleep.h"

static vec *take_stream(struct world *w, vec *had, int64_t n)
{
    return had ? had : w->run->take(w->on, ARENA_STATE, n, sizeof *had);
}

/* Takes the streams that have not been taken yet. Some may have been taken by
 * an earlier call that then ran out of memory. */
static int take_start(struct world *w)
{
    struct saved_state *s = &w->saved;
    s->x = take_stream(w, s->x, w->nv);
    s->v = take_stream(w, s->v, w->nv);
    if (w->past_x) {
        s->past_x = take_stream(w, s->past_x, w->nc);
        s->past_v = take_stream(w, s->past_v, w->nc);
    }
    if (w->anchor)
        s->anchor = take_stream(w, s->anchor, w->nc);
    if (!s->watch)
        s->watch = arena_take(w->arena, ARENA_STATE, w->def.n_cloths,
                              sizeof *s->watch);
    return s->watch ? w->run->status(w->on) : DRAPE_ENOMEM;
}

/* Copies the streams of the state from one set to another. */
static void copy_state(const struct world *w, struct saved_state *to,
                       const struct saved_state *from)
{
    size_t n = (size_t)w->nv * sizeof(vec),
           cloths = (size_t)w->nc * sizeof(vec);
    w->run->copy(w->on, to->x, from->x, n);
    w->run->copy(w->on, to->v, from->v, n);
    if (w->past_x) {
        w->run->copy(w->on, to->past_x, from->past_x, cloths);
        w->run->copy(w->on, to->past_v, from->past_v, cloths);
    }
    if (w->anchor)
        w->run->copy(w->on, to->anchor, from->anchor, cloths);
    memcpy(to->watch, from->watch, (size_t)w->def.n_cloths * sizeof *to->watch);
}

/* Returns the world's own streams of the state. */
static struct saved_state current_state(const struct world *w)
{
    return (struct saved_state){.x = w->x0,
                                .v = w->v0,
                                .past_x = w->past_x,
                                .past_v = w->past_v,
                                .watch = w->watch,
                                .anchor = w->anchor};
}

/* Copies the multipliers that contacts carry on. */
static int copy_kept(const struct world *w, struct pool *to, int64_t *n_to,
                     const struct pool *from, int64_t n)
{
    int status = DRAPE_OK;
    *n_to = 0;
    if (n > to->cap)
        status = w->run->grow(w->on, to, n, sizeof(struct kept), true);
    if (status != DRAPE_OK)
        return status;
    w->run->copy(w->on, to->data, from->data, (size_t)n * sizeof(struct kept));
    *n_to = n;
    return DRAPE_OK;
}

int restore_save(struct world *w)
{
    struct saved_state *s = &w->saved, from = current_state(w);
    int status = take_start(w);
    if (status != DRAPE_OK)
        return status;
    copy_state(w, s, &from);
    s->nearness = w->nearness;
    status = copy_kept(w, &s->kept, &s->n_kept, &w->lagrange.kept[0],
                       w->lagrange.n_kept[0]);
    return status == DRAPE_OK ? w->run->status(w->on) : status;
}

void restore_start(struct world *w)
{
    const struct saved_state *s = &w->saved;
    struct saved_state to = current_state(w);
    w->run->begin(w->on); /* a recorded lack of memory would stop the copies */
    sleep_undo(w);
    if (w->slicing.done == 0)
        return; /* no slice was committed */
    copy_state(w, &to, s);
    w->nearness = s->nearness;
    /* where there is no room they are forgotten: contacts begin anew */
    copy_kept(w, &w->lagrange.kept[0], &w->lagrange.n_kept[0], &s->kept,
              s->n_kept);
}
