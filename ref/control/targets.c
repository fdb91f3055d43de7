/* SPDX-License-Identifier: Apache-2.0 */
/* Live control of pins and obstacles, for either backend: where the caller
 * moves vertices in the next step. spec/control/control.md §3, §4, §5 */
#include "ref/base/change.h"
#include "ref/control/control.h"
#include "ref/sleep/sleep.h"
#include "ref/world/start.h"

int control_take_targets(struct world *w)
{
    struct targets *t = &w->targets;
    if (!t->from)
        t->from = w->run->take(w->on, ARENA_STATE, w->nv, sizeof *t->from);
    if (!t->to)
        t->to = w->run->take(w->on, ARENA_STATE, w->nv, sizeof *t->to);
    return t->from && t->to ? DRAPE_OK : w->run->status(w->on);
}

/* §3: a target is set; a vertex without one stays. */
static void arm_targets(struct world *w)
{
    size_t bytes = (size_t)w->nv * sizeof *w->x0;
    if (!w->targets.armed)
        w->run->copy(w->on, w->targets.to, w->x0, bytes);
    w->targets.armed = true;
    w->plan.prescribed = true;
    sleep_wake(w);
}

void control_begin(struct world *w)
{
    bool moves = false;
    if (w->targets.armed) /* from where they are, whatever was set since */
        w->run->copy(w->on, w->targets.from, w->x0,
                     (size_t)w->nv * sizeof *w->x0);
    for (int k = 0; k < w->def.n_obstacles && w->targets.armed; k++)
        moves |= w->prop[k].targeted && !w->prop[k].moves;
    w->broad.restless = moves;
    if (w->targets.stirred && !moves)
        w->broad.started = false; /* where it stands now */
    w->targets.stirred = moves;
}

void control_end(struct world *w, bool failed)
{
    if (!failed) {
        w->targets.armed = false;
        control_end_seams(w);
    }
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

void control_drop_pins(struct world *w, struct caller_pins *pins)
{
    arena_give(w->arena, pins->list);
    w->run->give(w->on, pins->at);
    w->run->give(w->on, pins->x);
    *pins = (struct caller_pins){0};
}

int control_make_pins(struct world *w, int64_t n, const int32_t *particle,
                      struct caller_pins *pins)
{
    size_t bytes = (size_t)n * sizeof *particle;
    *pins = (struct caller_pins){.on = true, .n = n};
    pins->list = arena_take(w->arena, ARENA_CLOTH, n, sizeof *pins->list);
    pins->at = w->run->take(w->on, ARENA_CLOTH, n, sizeof *pins->at);
    pins->x = w->run->take(w->on, ARENA_CLOTH, n, sizeof *pins->x);
    if (!w->to)
        w->to = w->run->take(w->on, ARENA_STATE, w->nc, sizeof *w->to);
    if (!pins->list || !pins->at || !pins->x || !w->to) {
        control_drop_pins(w, pins);
        return DRAPE_ENOMEM;
    }
    if (n > 0)
        memcpy(pins->list, particle, bytes);
    w->run->send(w->on, pins->at, pins->list, bytes);
    return w->run->status(w->on);
}

/* Exchanges the pins of a cloth for these. DRAPE_ELIMIT, and the old pins hold,
 * if that needs more substeps than max_substeps. */
static int exchange_pins(struct world *w, int cloth, struct caller_pins *pins,
                         uint8_t *fixed)
{
    struct sheet *s = &w->sheet[cloth];
    struct cloth *c = &w->home->sheet[cloth].cloth, was = *c;
    for (int64_t p = 0; p < c->count; p++) {
        uint8_t old = c->fixed[p];
        c->fixed[p] = fixed[p];
        fixed[p] = old;
    }
    c->n_pinned = pins->n;
    ref_cloth_weigh(c);
    if (start_too_stiff(w, c)) {
        memcpy(c->fixed, fixed, (size_t)c->count);
        *c = was;
        return DRAPE_ELIMIT;
    }
    struct caller_pins old = s->caller_pins;
    s->caller_pins = *pins;
    *pins = old;
    control_tell_cloth(w, cloth);
    return DRAPE_OK;
}

static int replace_pins(struct world *w, int cloth, int64_t n,
                        const int32_t *particle)
{
    const struct cloth *c = &w->home->sheet[cloth].cloth;
    struct caller_pins pins = {0};
    uint8_t *fixed = arena_take(w->arena, ARENA_OTHER, c->count, 1);
    int status = fixed ? control_mark(c, n, particle, fixed) : DRAPE_ENOMEM;
    if (status == DRAPE_OK)
        status = control_make_pins(w, n, particle, &pins);
    if (status == DRAPE_OK)
        status = exchange_pins(w, cloth, &pins, fixed);
    control_drop_pins(w, &pins);
    arena_give(w->arena, fixed);
    return status;
}

static bool has_pins(const struct caller_pins *pins, int64_t n,
                     const int32_t *particle)
{
    return pins->on && pins->n == n &&
           (n == 0 ||
            !memcmp(pins->list, particle, (size_t)n * sizeof *particle));
}

int control_pins(struct world *w, int cloth, int64_t n, const int32_t *particle,
                 struct given x)
{
    struct sheet *s = &w->sheet[cloth];
    vec *target = w->x1 + s->first; /* the cloth's part is free between steps */
    w->run->begin(w->on);
    w->arena->failed = false;
    int status = control_take_targets(w);
    if (status == DRAPE_OK && (x.here || x.there))
        status = control_take(w, x, n, w->home->x1 + s->first, target);
    if (status == DRAPE_OK && !has_pins(&s->caller_pins, n, particle))
        status = replace_pins(w, cloth, n, particle);
    if (status != DRAPE_OK)
        return status;
    arm_targets(w);
    vec *to = w->targets.to + s->first;
    w->run->copy(w->on, to, w->x0 + s->first,
                 (size_t)s->cloth.count * sizeof *to);
    if (x.here || x.there)
        w->run->prescribed_pin(w->on, n, s->caller_pins.at, target, to);
    return w->run->status(w->on);
}

/* §5 */

static int tell_obstacle(struct world *w, struct prop *p)
{
    vec *x1 = w->x1 + p->first;
    size_t bytes = (size_t)p->place.n * sizeof *x1;
    arm_targets(w);
    w->run->copy(w->on, w->targets.to + p->first, x1, bytes);
    p->targeted = true;
    w->broad.apart.able &= p->moves;
    return w->run->status(w->on);
}

/* Puts back x1 of an obstacle, which no step writes if it never moves. */
static int restore_obstacle(struct world *w, const struct prop *p, int status)
{
    w->run->copy(w->on, w->x1 + p->first, w->x0 + p->first,
                 (size_t)p->place.n * sizeof *w->x1);
    return status;
}

int control_obstacle(struct world *w, int obstacle, struct given x)
{
    struct prop *p = &w->prop[obstacle];
    w->run->begin(w->on);
    int status = control_take_targets(w);
    if (status == DRAPE_OK)
        status = control_take(w, x, p->place.n, w->home->x1 + p->first,
                              w->x1 + p->first);
    return status == DRAPE_OK ? tell_obstacle(w, p)
                              : restore_obstacle(w, p, status);
}

int control_pose(struct world *w, int obstacle, const drape_motion *motion)
{
    struct prop *p = &w->prop[obstacle];
    struct pose pose = kinematics_pose(motion, 0);
    if (p->frame)
        return DRAPE_EARG;
    w->run->begin(w->on);
    int status = control_take_targets(w);
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
    return status == DRAPE_OK ? tell_obstacle(w, p)
                              : restore_obstacle(w, p, status);
}
