/* SPDX-License-Identifier: Apache-2.0 */
/* The wind of a world, on either backend. spec/cloth/wind.md */
#include "ref/world/air.h"

static void *take_array(struct world *w, void *had, int64_t n, size_t size)
{
    return had ? had : w->run->take(w->on, ARENA_SOLVER, n, size);
}

int air_take(struct world *w)
{
    for (int k = 0; k < w->def.n_cloths; k++) {
        struct dynamics *d = &w->sheet[k].dynamics;
        int64_t n = w->sheet[k].cloth.count;
        d->wind = take_array(w, d->wind, n, sizeof *d->wind);
        if (w->plan.implicit)
            d->inertia = take_array(w, d->inertia, n, sizeof *d->inertia);
        if (!w->device)
            d->gust = take_array(w, d->gust, 2 * n, sizeof *d->gust);
        if (!w->device && w->plan.implicit)
            d->resist = take_array(w, d->resist, 2 * n, sizeof *d->resist);
    }
    return w->run->status(w->on);
}

void air_set(struct world *w, const drape_wind *wind)
{
    w->def.wind = *wind;
    /* by the definition and by what the world has now, and not by what it had
     * in between: a checkpoint holds these two */
    w->plan.wind = plan_windy(&w->defined_wind) || plan_windy(wind);
    for (int k = 0; k < w->def.n_cloths; k++) {
        struct sheet *s = &w->sheet[k];
        struct dynamics *d = &s->dynamics;
        d->windy = w->plan.wind;
        d->air = vec_make((real)wind->velocity[0], (real)wind->velocity[1],
                          (real)wind->velocity[2]);
        d->drag = (real)(0.5 * wind->density * wind->drag);
        d->lift = (real)(0.5 * wind->density * wind->lift);
        if (w->plan.implicit)
            s->solver.pcg.mass = w->plan.wind ? d->inertia : s->cloth.mass;
    }
}
