/* SPDX-License-Identifier: Apache-2.0 */
/* Which cloths are asleep, on either backend. spec/sleep/sleep.md */
#include "ref/sleep/sleep.h"

#include "ref/base/prescribed.h"
#include "ref/contact/kept.h"
#include "ref/momentum/conserve.h"
#include "ref/sleep/wake.h"
#include "ref/world/slice.h"

/* Of the largest thickness, §1: how far a cloth at rest goes in the mean of a
 * step, and in all. */
static const double DRIFT = 1e-3, SWAY = 0.25;

static int count_bodies(const struct world *w)
{
    return w->def.n_cloths + w->def.n_obstacles;
}

const double *sleep_energy(const struct world *w, int k)
{
    const struct held *held = &w->sleep->held[k];
    return held->on ? held->energy : NULL;
}

int sleep_make(struct world *w)
{
    struct arena *a = w->arena;
    int n = w->def.n_cloths;
    struct sleep *s = w->sleep = arena_take(a, ARENA_OTHER, 1, sizeof *s);
    if (!s)
        return DRAPE_ENOMEM;
    s->rest = arena_take(a, ARENA_STATE, n, sizeof *s->rest);
    s->was = arena_take(a, ARENA_STATE, n, sizeof *s->was);
    s->held = arena_take(a, ARENA_OTHER, n, sizeof *s->held);
    s->most = arena_take(a, ARENA_OTHER, count_bodies(w), sizeof *s->most);
    s->of = arena_take(a, ARENA_OTHER, n, sizeof *s->of);
    s->flag = arena_take(a, ARENA_OTHER, count_bodies(w), 1);
    return a->failed ? DRAPE_ENOMEM : DRAPE_OK;
}

void sleep_weigh(struct world *w, int k)
{
    struct world *h = w->home;
    const struct cloth *c = &h->sheet[k].cloth;
    int64_t first = h->sheet[k].first;
    for (int64_t p = 0; p < c->count; p++)
        h->w[first + p] = c->fixed[p] ? 0 : 1 / c->mass[p];
    if (w->w != h->w)
        w->run->send(w->on, w->w + first, h->w + first,
                     (size_t)c->count * sizeof *w->w);
}

void sleep_wake(struct world *w)
{
    memset(w->sleep->rest, 0, (size_t)w->def.n_cloths * sizeof *w->sleep->rest);
    w->sleep->n = 0;
}

void sleep_forget(struct world *w)
{
    struct sleep *s = w->sleep;
    s->n = 0;
    for (int k = 0; k < w->def.n_cloths; k++) {
        s->n += s->rest[k].asleep;
        if (s->held[k].on)
            sleep_weigh(w, k);
        s->held[k] = (struct held){0};
    }
    w->broad.awake = NULL;
}

void sleep_note(struct world *w)
{
    struct sleep *s = w->sleep;
    memcpy(s->was, s->rest, (size_t)w->def.n_cloths * sizeof *s->was);
    s->past = w->past;
}

void sleep_undo(struct world *w)
{
    struct sleep *s = w->sleep;
    memcpy(s->rest, s->was, (size_t)w->def.n_cloths * sizeof *s->rest);
    w->past = s->past;
    sleep_forget(w);
}

/* §3: cloths that are held */

static void *take_stream(struct world *w, void *had, int64_t n, size_t size)
{
    return had ? had : w->run->take(w->on, ARENA_STATE, n, size);
}

/* Takes the streams that have not been taken yet. */
static int take_streams(struct world *w)
{
    struct sleep *s = w->sleep;
    if (w->def.n_cloths > 1)
        s->label = take_stream(w, s->label, w->def.n_cloths, sizeof *s->label);
    if (w->plan.collides) {
        s->mask = take_stream(w, s->mask, w->nv, 1);
        s->awake = take_stream(w, s->awake, count_bodies(w), 1);
        s->active = take_stream(w, s->active, count_bodies(w), 1);
        s->disturbed = take_stream(w, s->disturbed, count_bodies(w), 1);
    }
    return w->run->status(w->on);
}

static bool can_move(const struct prop *p)
{
    return p->moves || p->targeted;
}

/* §3: the queries look at cloths that are awake, and at obstacles that may
 * move. */
static void send_mask(struct world *w)
{
    struct sleep *s = w->sleep;
    s->epoch++;
    if (!w->plan.collides)
        return;
    for (int k = 0; k < w->def.n_cloths; k++)
        s->flag[k] = sleep_awake(w, k);
    for (int k = 0; k < w->def.n_obstacles; k++)
        s->flag[w->def.n_cloths + k] = can_move(&w->prop[k]);
    w->run->send(w->on, s->awake, s->flag, (size_t)count_bodies(w));
    w->run->wake_mask(w->on, w->nv, w->body, s->awake, s->mask);
    w->broad.awake = s->n > 0 ? s->mask : NULL;
}

/* Holds cloth k: its particles are as those of obstacles. */
static void hold_cloth(struct world *w, int k)
{
    const struct sheet *c = &w->sheet[k];
    int64_t first = c->first, n = c->cloth.count;
    w->run->clear(w->on, w->w + first, (size_t)n * sizeof *w->w);
    memset(w->home->w + first, 0, (size_t)n * sizeof *w->w);
    w->sleep->held[k].on = true;
    w->broad.made = false; /* its boxes are of a motion */
}

static void release_cloth(struct world *w, int k)
{
    sleep_weigh(w, k);
    w->sleep->held[k].on = w->sleep->held[k].known = false;
}

/* The end of a slice of a cloth that is held is its start. */
static void keep_place(struct world *w, int k)
{
    const struct sheet *c = &w->sheet[k];
    size_t bytes = (size_t)c->cloth.count * sizeof *w->x1;
    w->run->copy(w->on, w->x1 + c->first, w->x0 + c->first, bytes);
    w->run->copy(w->on, w->v1 + c->first, w->v0 + c->first, bytes);
}

static void weigh_energy(struct world *w, int k)
{
    struct sheet *c = &w->sheet[k];
    struct held *held = &w->sleep->held[k];
    if (!held->known)
        w->run->motion_energy(w->on, c, w->x0 + c->first, w->v0 + c->first,
                              held->energy);
    held->known = true;
}

/* Whether a step has to look who sleeps: someone does, is still held, has been
 * woken since the state was loaded, or may fall asleep in it. */
static bool is_needed(const struct world *w)
{
    const struct sleep *s = w->sleep;
    bool any = s->n > 0 || w->lagrange.n_resting > 0;
    for (int k = 0; k < w->def.n_cloths; k++)
        any |= s->held[k].on ||
               (w->def.n_cloths > 1 && s->rest[k].steps >= SLEEP_STEPS - 1);
    return any;
}

int sleep_hold(struct world *w)
{
    struct sleep *s = w->sleep;
    bool changed = s->n == 0 && w->lagrange.n_resting > 0;
    if (!is_needed(w))
        return DRAPE_OK;
    int status = take_streams(w);
    for (int k = 0; k < w->def.n_cloths && status == DRAPE_OK; k++) {
        bool asleep = !sleep_awake(w, k);
        if (asleep == s->held[k].on)
            continue;
        changed = true;
        if (asleep)
            hold_cloth(w, k);
        else
            release_cloth(w, k);
    }
    if (changed) {
        send_mask(w);
        status = kept_divide(w);
    }
    for (int k = 0; k < w->def.n_cloths && status == DRAPE_OK; k++)
        if (!sleep_awake(w, k)) {
            keep_place(w, k);
            weigh_energy(w, k);
        }
    return status == DRAPE_OK ? w->run->status(w->on) : status;
}

/* §4: cloths that wake */

/* Wakes the cloths whose islands are marked in flag. A past of another length
 * than this slice's is none. */
static int wake_marked(struct world *w)
{
    struct sleep *s = w->sleep;
    bool changed = false;
    for (int k = 0; k < w->def.n_cloths; k++) {
        struct rest *rest = &s->rest[k];
        if (!rest->asleep || !s->of[rest->group])
            continue;
        if (rest->past != 1 + w->slicing.level)
            w->past = 0;
        *rest = (struct rest){0};
        s->n--;
        release_cloth(w, k);
        changed = true;
    }
    if (!changed)
        return DRAPE_OK;
    send_mask(w);
    return kept_divide(w);
}

/* Marks in `of` the islands of cloths that are asleep and have a flag. */
static void mark_islands(struct world *w, const uint8_t *flag)
{
    struct sleep *s = w->sleep;
    memset(s->of, 0, (size_t)w->def.n_cloths * sizeof *s->of);
    for (int k = 0; k < w->def.n_cloths; k++)
        if (s->rest[k].asleep && flag[k])
            s->of[s->rest[k].group] = 1;
}

/* Whether a pin of cloth k has another place at the end of the slice. */
static bool pins_move(const struct world *w, int k)
{
    const struct sheet *c = &w->sheet[k];
    struct pins pins = sheet_pins(c);
    return w->prescribes && pins.n > 0 &&
           w->run->prescribed_differs(w->on, pins.n, pins.at, w->x0 + c->first,
                                      pins.x);
}

static bool obstacle_moves(const struct world *w, const struct prop *p)
{
    return w->prescribes && can_move(p) &&
           w->run->prescribed_differs(w->on, p->place.n, NULL, w->x0 + p->first,
                                      w->x1 + p->first);
}

int sleep_begin_slice(struct world *w)
{
    struct sleep *s = w->sleep;
    s->woken = false;
    if (s->n == 0)
        return DRAPE_OK;
    for (int k = 0; k < w->def.n_cloths; k++)
        s->flag[k] = s->rest[k].asleep && pins_move(w, k);
    mark_islands(w, s->flag);
    int status = wake_marked(w);
    for (int k = 0; k < w->def.n_cloths; k++)
        s->flag[k] = sleep_awake(w, k);
    for (int k = 0; k < w->def.n_obstacles; k++)
        s->flag[w->def.n_cloths + k] = obstacle_moves(w, &w->prop[k]);
    if (w->plan.collides) {
        w->run->send(w->on, s->active, s->flag, (size_t)count_bodies(w));
        w->run->clear(w->on, s->disturbed, (size_t)count_bodies(w));
    }
    return status == DRAPE_OK ? w->run->status(w->on) : status;
}

int sleep_notice(struct world *w)
{
    struct sleep *s = w->sleep;
    struct wake r = {.n = w->broad.n,
                     .pair = broad_pairs(&w->broad),
                     .body = w->body,
                     .active = s->active,
                     .disturbed = s->disturbed};
    if (s->n == 0 || r.n == 0)
        return DRAPE_OK;
    w->run->wake_find(w->on, &r);
    w->run->fetch(w->on, s->flag, s->disturbed, (size_t)count_bodies(w));
    int status = w->run->status(w->on);
    for (int k = 0; k < w->def.n_cloths && status == DRAPE_OK; k++)
        s->woken |= s->rest[k].asleep && s->flag[k];
    return status;
}

int sleep_wake_disturbed(struct world *w)
{
    mark_islands(w, w->sleep->flag);
    w->sleep->woken = false;
    return wake_marked(w);
}

/* §1: who falls asleep. */

/* Finds how far the cloths are from where their anchors are, squared. */
static void measure_cloths(struct world *w)
{
    struct sleep *s = w->sleep;
    int n = w->def.n_cloths;
    if (n == 1)
        s->most[0] =
            w->run->prescribed_furthest(w->on, w->nc, w->anchor, w->x1);
    else
        w->run->wake_displacements(w->on, w->nc, w->body, w->anchor, w->x1, n,
                                   s->most);
}

/* Sets the anchors of cloths first … end - 1 where they are. */
static void set_anchors(struct world *w, int first, int end)
{
    if (first == end)
        return;
    const struct sheet *last = &w->sheet[end - 1];
    int64_t from = w->sheet[first].first;
    size_t n = (size_t)(last->first + last->cloth.count - from);
    w->run->copy(w->on, w->anchor + from, w->x1 + from, n * sizeof *w->x1);
}

/* Counts a step of cloth k. Returns whether its anchor is to be set anew. */
static bool count_step(struct world *w, int k, bool failed)
{
    struct rest *rest = &w->sleep->rest[k];
    double far = sqrt((double)w->sleep->most[k]);
    bool near = rest->steps > 0 && far <= SWAY * (double)w->reach;
    if (failed || !near) {
        *rest = (struct rest){.steps = !failed};
        return !failed;
    }
    rest->far = far > rest->far ? far : rest->far;
    rest->steps += rest->steps < SLEEP_MOST;
    return false;
}

/* Whether cloth k has rested for long enough. */
static bool may_sleep(const struct world *w, int k)
{
    const struct rest *rest = &w->sleep->rest[k];
    return !rest->asleep && rest->steps >= SLEEP_STEPS &&
           rest->far <= rest->steps * DRIFT * (double)w->reach &&
           !pins_move(w, k);
}

/* Finds the island of each cloth: those of the slice's contacts. With an
 * explicit integrator, whose contacts are not kept, all are one. */
static int find_islands(struct world *w)
{
    return conserve_find_islands(w, !w->plan.implicit, w->sleep->label,
                                 w->sleep->of);
}

/* Puts the islands to sleep of which all cloths have rested long enough. */
static void put_to_sleep(struct world *w)
{
    struct sleep *s = w->sleep;
    int n = w->def.n_cloths;
    bool any = false;
    for (int k = 0; k < n; k++)
        any |= s->flag[k] = may_sleep(w, k);
    if (!any || find_islands(w) != DRAPE_OK)
        return;
    for (int k = 0; k < n; k++) /* one that is not keeps its island awake */
        if (sleep_awake(w, k) && !s->flag[k])
            s->flag[s->of[k]] = 0;
    for (int k = 0; k < n; k++) {
        struct rest *rest = &s->rest[k];
        if (rest->asleep || !s->flag[s->of[k]])
            continue;
        *rest = (struct rest){.asleep = 1, .group = s->of[k], .past = w->past};
        s->n++;
    }
}

void sleep_count(struct world *w, int outcome)
{
    struct sleep *s = w->sleep;
    int n = w->def.n_cloths, first = 0;
    bool anchored = false;
    if (!w->def.sleep || sleep_all(w) || slice_part(w) < 1)
        return;
    for (int k = 0; k < n; k++)
        anchored |= sleep_awake(w, k) && s->rest[k].steps > 0;
    if (anchored)
        measure_cloths(w);
    for (int k = 0; k < n; k++) {
        if (sleep_awake(w, k) && count_step(w, k, slice_failed(outcome)))
            continue;
        set_anchors(w, first, k);
        first = k + 1;
    }
    set_anchors(w, first, n);
    put_to_sleep(w);
}

/* §3: work on the cloths that are awake */

void sleep_runs(struct world *w,
                void (*work)(struct world *w, int64_t first, int64_t n))
{
    for (int k = 0, end; k < w->def.n_cloths; k = end + 1) {
        for (end = k; end < w->def.n_cloths && sleep_awake(w, end);)
            end++;
        if (end == k)
            continue;
        const struct sheet *last = &w->sheet[end - 1];
        int64_t first = w->sheet[k].first;
        work(w, first, last->first + last->cloth.count - first);
    }
}

void sleep_clear(struct world *w, void *a, size_t size)
{
    for (int k = 0; k < w->def.n_cloths && w->sleep->n > 0 && a; k++)
        if (!sleep_awake(w, k))
            w->run->clear(w->on, (char *)a + (size_t)w->sheet[k].first * size,
                          (size_t)w->sheet[k].cloth.count * size);
}
