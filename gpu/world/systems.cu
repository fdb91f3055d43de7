/* SPDX-License-Identifier: Apache-2.0 */
/* Gathers the systems of a world's cloths for the joint solve.
 * spec/contact/penalty.md §4 */
#include "gpu/run/launch.cuh"

extern "C" {
#include "gpu/cloth/sheet.h"
#include "gpu/contact/joint.h"
#include "gpu/world/state.h"
#include "gpu/world/systems.h"
#include "ref/sleep/sleep.h"
}

int gpu_systems_make(struct gpu_world *w)
{
    w->part = (struct joint_part *)arena_take(
        w->world.arena, ARENA_OTHER, w->world.def.n_cloths, sizeof *w->part);
    return w->part ? DRAPE_OK : DRAPE_ENOMEM;
}

int gpu_systems_joint(struct world *w, struct joint *s)
{
    struct gpu_world *d = w->device;
    int n = 0;
    for (int k = 0; k < w->def.n_cloths; k++) {
        const struct sheet *a = &w->sheet[k];
        struct joint_part *p = &d->part[n];
        if (!sleep_awake(w, k))
            continue;
        n++;
        p->pcg = a->solver.pcg;
        p->pcg.block = a->dynamics.block;
        p->pcg.thin = a->dynamics.thin;
        p->rate = a->device->rate;
        p->first = a->first;
    }
    const struct joint_system all = {.gpu = d->gpu,
                                     .n = n,
                                     .part = d->part,
                                     .joint = s,
                                     .links = d->links,
                                     .mutual_end = d->mutual_end,
                                     .mutual = d->mutual,
                                     .w = w->w};
    return gpu_joint(&all);
}
