/* SPDX-License-Identifier: Apache-2.0 */
/* Live control of pins and obstacles, for either backend: where the caller
 * leads vertices in the next step. spec/control/control.md §3, §4, §5 */
#include "ref/api/ops.h"
#include "ref/control/control.h"
#include "ref/sleep/sleep.h"
#include "ref/world/start.h"

int control_take_told(struct world *w)
{
    struct told *t = &w->told;
    if (!t->from)
        t->from = w->run->take(w->on, ARENA_STATE, w->nv, sizeof *t->from);
    if (!t->to)
        t->to = w->run->take(w->on, ARENA_STATE, w->nv, sizeof *t->to);
    return t->from && t->to ? DRAPE_OK : w->run->status(w->on);
}

/* §3: a target is told: what is led goes there from where it is. */
static void arm(struct world *w)
{
    size_t bytes = (size_t)w->nv * sizeof *w->x0;
    if (!w->told.armed) { /* what is told no other target stays */
        w->run->copy(w->on, w->told.from, w->x0, bytes);
        w->run->copy(w->on, w->told.to, w->x0, bytes);
    }
    w->told.armed = true;
    w->plan.led = true;
    sleep_wake(w);
}

void control_begin(struct world *w)
{
    bool moves = false;
    for (int k = 0; k < w->def.n_obstacles && w->told.armed; k++)
        moves |= w->prop[k].told && !w->prop[k].moves;
    w->broad.restless = moves;
    if (w->told.stirred && !moves)
        w->broad.started = false; /* where it stands now */
    w->told.stirred = moves;
}

void control_end(struct world *w, bool failed)
{
    if (!failed)
        w->told.armed = false;
    w->list.known = !failed;
}

/* §4 */

int control_mark(const struct cloth *c, int64_t n, const int32_t *particle,
                 uint8_t *fixed)
{
    for (int64_t p = 0; p < c->count; p++)
        fixed[p] = c->fixed[p] == CLOTH_ABSENT ? CLOTH_ABSENT : 0;
    for (int64_t i = 0; i < n; i++) {
        int32_t p = particle[i];
        if (p < 0 || p >= c->count || fixed[p])
            return DRAPE_EARG;
        fixed[p] = CLOTH_PINNED;
    }
    return DRAPE_OK;
}

void control_drop_hand(struct world *w, struct hand *hand)
{
    arena_give(w->arena, hand->list);
    w->run->give(w->on, hand->at);
    w->run->give(w->on, hand->x);
    *hand = (struct hand){0};
}

int control_make_hand(struct world *w, int64_t n, const int32_t *particle,
                      struct hand *hand)
{
    size_t bytes = (size_t)n * sizeof *particle;
    *hand = (struct hand){.on = true, .n = n};
    hand->list = arena_take(w->arena, ARENA_CLOTH, n, sizeof *hand->list);
    hand->at = w->run->take(w->on, ARENA_CLOTH, n, sizeof *hand->at);
    hand->x = w->run->take(w->on, ARENA_CLOTH, n, sizeof *hand->x);
    if (!w->to)
        w->to = w->run->take(w->on, ARENA_STATE, w->nc, sizeof *w->to);
    if (!hand->list || !hand->at || !hand->x || !w->to) {
        control_drop_hand(w, hand);
        return DRAPE_ENOMEM;
    }
    if (n > 0)
        memcpy(hand->list, particle, bytes);
    w->run->send(w->on, hand->at, hand->list, bytes);
    return w->run->status(w->on);
}

/* Exchanges the pins of a cloth for these. DRAPE_ELIMIT, and the old pins hold,
 * if that needs more substeps than max_substeps. */
static int exchange(struct world *w, int cloth, struct hand *hand,
                    uint8_t *fixed)
{
    struct sheet *s = &w->sheet[cloth];
    struct cloth *c = &w->home->sheet[cloth].cloth, was = *c;
    for (int64_t p = 0; p < c->count; p++) {
        uint8_t old = c->fixed[p];
        c->fixed[p] = fixed[p];
        fixed[p] = old;
    }
    c->n_pinned = hand->n;
    ref_cloth_weigh(c);
    if (start_too_stiff(w, c)) {
        memcpy(c->fixed, fixed, (size_t)c->count);
        *c = was;
        return DRAPE_ELIMIT;
    }
    struct hand old = s->hand;
    s->hand = *hand;
    *hand = old;
    control_tell_cloth(w, cloth);
    return DRAPE_OK;
}

static int replace(struct world *w, int cloth, int64_t n,
                   const int32_t *particle)
{
    const struct cloth *c = &w->home->sheet[cloth].cloth;
    struct hand hand = {0};
    uint8_t *fixed = arena_take(w->arena, ARENA_OTHER, c->count, 1);
    int status = fixed ? control_mark(c, n, particle, fixed) : DRAPE_ENOMEM;
    if (status == DRAPE_OK)
        status = control_make_hand(w, n, particle, &hand);
    if (status == DRAPE_OK)
        status = exchange(w, cloth, &hand, fixed);
    control_drop_hand(w, &hand);
    arena_give(w->arena, fixed);
    return status;
}

static bool holds(const struct hand *hand, int64_t n, const int32_t *particle)
{
    return hand->on && hand->n == n &&
           (n == 0 ||
            !memcmp(hand->list, particle, (size_t)n * sizeof *particle));
}

int control_pins(struct world *w, int cloth, int64_t n, const int32_t *particle,
                 struct given x)
{
    struct sheet *s = &w->sheet[cloth];
    vec *told = w->x1 + s->first; /* the cloth's part is free between steps */
    w->run->begin(w->on);
    w->arena->failed = false;
    int status = control_take_told(w);
    if (status == DRAPE_OK && (x.here || x.there))
        status = control_take(w, x, n, w->home->x1 + s->first, told);
    if (status == DRAPE_OK && !holds(&s->hand, n, particle))
        status = replace(w, cloth, n, particle);
    if (status != DRAPE_OK)
        return status;
    arm(w);
    vec *to = w->told.to + s->first;
    w->run->copy(w->on, to, w->x0 + s->first,
                 (size_t)s->cloth.count * sizeof *to);
    if (x.here || x.there)
        w->run->pin(w->on, n, s->hand.at, told, to);
    return w->run->status(w->on);
}

/* §5 */

static int tell_obstacle(struct world *w, struct prop *p)
{
    vec *x1 = w->x1 + p->first;
    size_t bytes = (size_t)p->place.n * sizeof *x1;
    arm(w);
    w->run->copy(w->on, w->told.to + p->first, x1, bytes);
    p->told = true;
    w->broad.apart.able &= p->moves;
    return w->run->status(w->on);
}

/* Puts back x1 of an obstacle, which no step writes if it never moves. */
static int refuse(struct world *w, const struct prop *p, int status)
{
    w->run->copy(w->on, w->x1 + p->first, w->x0 + p->first,
                 (size_t)p->place.n * sizeof *w->x1);
    return status;
}

int control_obstacle(struct world *w, int obstacle, struct given x)
{
    struct prop *p = &w->prop[obstacle];
    w->run->begin(w->on);
    int status = control_take_told(w);
    if (status == DRAPE_OK)
        status = control_take(w, x, p->place.n, w->home->x1 + p->first,
                              w->x1 + p->first);
    return status == DRAPE_OK ? tell_obstacle(w, p) : refuse(w, p, status);
}

int control_pose(struct world *w, int obstacle, const drape_motion *motion)
{
    struct prop *p = &w->prop[obstacle];
    struct pose pose = kinematics_pose(motion, 0);
    if (p->frames)
        return DRAPE_EARG;
    w->run->begin(w->on);
    int status = control_take_told(w);
    if (!p->none)
        p->none =
            w->run->take(w->on, ARENA_OBSTACLE, p->place.n, sizeof *p->none);
    if (!p->pose)
        p->pose = w->run->take(w->on, ARENA_OBSTACLE, 1, sizeof *p->pose);
    if (status == DRAPE_OK && (!p->none || !p->pose))
        status = w->run->status(w->on);
    if (status != DRAPE_OK)
        return status;
    w->run->send(w->on, p->pose, &pose, sizeof pose);
    struct kinematics k = {.n = p->place.n,
                           .rest = p->place.rest,
                           .motion = p->none,
                           .pose = p->pose,
                           .poses = 1,
                           .x = w->x1 + p->first};
    status = w->run->kinematics(w->on, &k);
    return status == DRAPE_OK ? tell_obstacle(w, p) : refuse(w, p, status);
}
