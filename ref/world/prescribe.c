/* SPDX-License-Identifier: Apache-2.0 */
/* Moves obstacles and pins to their prescribed places, for either backend.
 * spec/world/step.md §1 */
#include "ref/world/prescribe.h"

#include "ref/base/prescribed.h"
#include "ref/world/slice.h"

/* control.md §3: writes to x the places of n items of which `from` is the first
 * vertex, on their way to the caller's targets. */
static void blend_targets(const struct world *w, int64_t first, int64_t n,
                          const int32_t *at, vec *x)
{
    struct blend s = {.n = n,
                      .at = at,
                      .from = w->targets.from + first,
                      .to = w->targets.to + first,
                      .part = w->targets.armed ? slice_part(w) : 1,
                      .x = x};
    w->run->prescribed_blend(w->on, &s);
}

static int prescribe_obstacle(struct world *w, struct prop *p, double t, vec *x)
{
    if (p->targeted)
        blend_targets(w, p->first, p->place.n, NULL, x + p->first);
    if (p->targeted || (!p->moves && t > 0))
        return DRAPE_OK;
    if (p->frame)
        kinematics_frame(&p->frames, p->frame, t, &p->place);
    p->place.x = x + p->first;
    return w->run->kinematics(w->on, &p->place);
}

static int prescribe_pins(struct world *w, struct sheet *s)
{
    struct pins pins = sheet_pins(s);
    int status = DRAPE_OK;
    if (pins.n == 0)
        return DRAPE_OK;
    if (s->caller_pins.on)
        blend_targets(w, s->first, pins.n, pins.at, pins.x);
    else
        status = w->run->kinematics(w->on, &s->pins);
    w->run->prescribed_pin(w->on, pins.n, pins.at, pins.x, w->to + s->first);
    return status;
}

int prescribe_positions(struct world *w, double t, vec *x)
{
    int status = DRAPE_OK;
    if (!w->plan.prescribed && t > 0)
        return DRAPE_OK; /* placed at time 0, and nothing moves since */
    for (int k = 0; k < w->def.n_motions; k++)
        w->pose[k] = kinematics_pose(&w->def.motions[k], t);
    w->run->send(w->on, w->posed, w->pose,
                 (size_t)w->def.n_motions * sizeof *w->pose);
    for (int k = 0; k < w->def.n_obstacles && status == DRAPE_OK; k++)
        status = prescribe_obstacle(w, &w->prop[k], t, x);
    for (int k = 0; k < w->def.n_cloths && status == DRAPE_OK; k++)
        status = prescribe_pins(w, &w->sheet[k]);
    return status == DRAPE_OK ? w->run->status(w->on) : status;
}

bool prescribe_moves(const struct world *w)
{
    return w->plan.prescribed && w->run->prescribed_moves(w);
}

void prescribe_velocities(const struct world *w)
{
    w->run->prescribed_velocities(w->on, w->nv - w->nc, w->x0 + w->nc,
                                  w->x1 + w->nc, (real)w->dt, w->v1 + w->nc);
}
