/* SPDX-License-Identifier: Apache-2.0 */
/* What is led: obstacles and pins. spec/world/step.md §1 */
#include "ref/world/lead.h"

/* The frames about t, and how far between them. */
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
    for (int k = 0; k < w->def.n_motions; k++)
        w->pose[k] = kinematics_pose(&w->def.motions[k], t);
    for (int k = 0; k < w->def.n_obstacles && status == DRAPE_OK; k++) {
        struct prop *p = &w->prop[k];
        if (!p->moves && t > 0)
            continue;
        if (p->frames)
            find_frame(p, t);
        p->place.x = x + p->first;
        status = ref_kinematics(&p->place);
    }
    for (int k = 0; k < w->def.n_cloths && status == DRAPE_OK; k++) {
        struct sheet *s = &w->sheet[k];
        if (s->pins.n)
            status = ref_kinematics(&s->pins);
        for (int64_t i = 0; i < s->pins.n; i++)
            w->to[s->first + s->pinned[i]] = s->pins.x[i];
    }
    return status;
}

bool lead_moves(const struct world *w)
{
    if (!w->plan.led)
        return false;
    for (int64_t i = w->nc; i < w->nv; i++)
        if (memcmp(&w->x0[i], &w->x1[i], sizeof *w->x0) != 0)
            return true;
    for (int k = 0; k < w->def.n_cloths; k++) {
        const struct sheet *s = &w->sheet[k];
        for (int64_t i = 0; i < s->pins.n; i++) {
            const vec *x = w->x0 + s->first + s->pinned[i];
            if (memcmp(x, &s->pins.x[i], sizeof *x) != 0)
                return true;
        }
    }
    return false;
}

void lead_velocities(struct world *w)
{
    real dt = (real)w->dt;
    EACH_ITEM
    for (int64_t i = w->nc; i < w->nv; i++) {
        vec d = vec_sub(w->x1[i], w->x0[i]);
        w->v1[i] = vec_make(d.x / dt, d.y / dt, d.z / dt);
    }
}
