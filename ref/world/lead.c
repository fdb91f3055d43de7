/* SPDX-License-Identifier: Apache-2.0 */
/* Moves obstacles and pins to their prescribed places, for either backend.
 * spec/world/step.md §1 */
#include "ref/world/lead.h"

/* Sets the two frames between which time t lies, and the blend between them. */
static void find_frame(struct prop *p, double t)
{
    struct kinematics *k = &p->place;
    double at = t / p->frame_dt;
    int last = p->frames - 1, f = 0;
    k->blend = 0;
    if (at >= last)
        f = last;
    else if (at > 0) {
        f = (int)at;
        k->blend = at - f;
    }
    k->rest = p->frame + 3 * k->n * f;
    k->next = k->blend > 0 ? k->rest + 3 * k->n : NULL;
}

int lead(struct world *w, double t, vec *x)
{
    int status = DRAPE_OK;
    if (!w->plan.led && t > 0)
        return DRAPE_OK; /* placed at time 0, and nothing moves since */
    for (int k = 0; k < w->def.n_motions; k++)
        w->pose[k] = kinematics_pose(&w->def.motions[k], t);
    w->run->send(w->on, w->posed, w->pose,
                 (size_t)w->def.n_motions * sizeof *w->pose);
    for (int k = 0; k < w->def.n_obstacles && status == DRAPE_OK; k++) {
        struct prop *p = &w->prop[k];
        if (!p->moves && t > 0)
            continue;
        if (p->frames)
            find_frame(p, t);
        p->place.x = x + p->first;
        status = w->run->kinematics(w->on, &p->place);
    }
    for (int k = 0; k < w->def.n_cloths && status == DRAPE_OK; k++) {
        struct sheet *s = &w->sheet[k];
        if (s->pins.n == 0)
            continue;
        status = w->run->kinematics(w->on, &s->pins);
        w->run->pin(w->on, s->pins.n, s->pinned, s->pins.x, w->to + s->first);
    }
    return status == DRAPE_OK ? w->run->status(w->on) : status;
}

bool lead_moves(const struct world *w)
{
    return w->plan.led && w->run->moves(w);
}

void lead_velocities(const struct world *w)
{
    w->run->velocities(w->on, w->nv - w->nc, w->x0 + w->nc, w->x1 + w->nc,
                       (real)w->dt, w->v1 + w->nc);
}
