/* SPDX-License-Identifier: Apache-2.0 */
/* Keeps the state at the start of a step, and restores it if the step fails in
 * a later slice or after its last. The memory is taken when a start is first
 * kept. spec/world/step.md §7 */
#include "ref/world/restore.h"
#include "ref/contact/carry.h"
#include "ref/sleep/sleep.h"

/* Takes the streams that have not been taken yet. Some may have been taken by
 * an earlier call that then ran out of memory. */
static int take_start(struct world *w)
{
    const struct state_list now = state_streams(w);
    struct saved_state *s = &w->saved;
    for (int k = 0; k < STATE_STREAMS; k++)
        if (now.of[k].n && !s->stream[k])
            s->stream[k] =
                w->run->take(w->on, ARENA_STATE, now.of[k].n, sizeof(vec));
    if (!s->watch)
        s->watch = arena_take(w->arena, ARENA_STATE, w->def.n_cloths,
                              sizeof *s->watch);
    return s->watch ? w->run->status(w->on) : DRAPE_ENOMEM;
}

/* Copies the streams of the state to the saved ones, or back. */
static void copy_state(struct world *w, bool back)
{
    const struct state_list now = state_streams(w);
    struct saved_state *s = &w->saved;
    for (int k = 0; k < STATE_STREAMS; k++) {
        vec *own = *now.of[k].at, *kept = s->stream[k];
        w->run->copy(w->on, back ? own : kept, back ? kept : own,
                     (size_t)now.of[k].n * sizeof(vec));
    }
    memcpy(back ? w->watch : s->watch, back ? s->watch : w->watch,
           (size_t)w->def.n_cloths * sizeof *w->watch);
}

/* Copies the multipliers that contacts carry on. */
static int copy_kept(const struct world *w, struct pool *to, int64_t *n_to,
                     const struct pool *from, int64_t n)
{
    int status = DRAPE_OK;
    *n_to = 0;
    if (n > to->cap)
        status = w->run->grow(w->on, to, ARENA_RESPONSE, n, sizeof(struct kept),
                              true);
    if (status != DRAPE_OK)
        return status;
    w->run->copy(w->on, to->data, from->data, (size_t)n * sizeof(struct kept));
    *n_to = n;
    return DRAPE_OK;
}

int restore_save(struct world *w)
{
    struct saved_state *s = &w->saved;
    int status = take_start(w);
    if (status != DRAPE_OK)
        return status;
    copy_state(w, false);
    s->nearness = w->nearness;
    status = copy_kept(w, &s->kept, &s->n_kept, &w->lagrange.kept[0],
                       w->lagrange.n_kept[0]);
    return status == DRAPE_OK ? w->run->status(w->on) : status;
}

void restore_start(struct world *w)
{
    const struct saved_state *s = &w->saved;
    w->run->begin(w->on); /* a recorded lack of memory would stop the copies */
    sleep_undo(w);
    if (w->slicing.done == 0)
        return; /* no slice was committed */
    copy_state(w, true);
    w->nearness = s->nearness;
    /* where there is no room they are forgotten: contacts begin anew */
    copy_kept(w, &w->lagrange.kept[0], &w->lagrange.n_kept[0], &s->kept,
              s->n_kept);
}
