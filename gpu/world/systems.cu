/* SPDX-License-Identifier: Apache-2.0 */
/* Gathers the systems of a world's cloths for the joint solve.
 * spec/contact/lagrange.md §3.2 */
extern "C" {
#include "gpu/cloth/sheet.h"
#include "gpu/contact/joint.h"
#include "gpu/contact/queue.h"
#include "gpu/world/state.h"
#include "gpu/world/systems.h"
#include "ref/sleep/rest.h"
}

int gpu_systems_make(struct gpu_world *w)
{
    w->part = (struct joint_part *)arena_take(
        w->world.arena, ARENA_OTHER, w->world.def.n_cloths, sizeof *w->part);
    return w->part ? DRAPE_OK : DRAPE_ENOMEM;
}

/* The systems of the cloths that are awake. */
static struct joint_system systems_of(struct world *w, struct joint *s)
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
    return (struct joint_system){.gpu = d->gpu,
                                 .n = n,
                                 .part = d->part,
                                 .joint = s,
                                 .links = d->links,
                                 .mutual_end = d->mutual_end,
                                 .mutual = d->mutual,
                                 .w = w->w};
}

/* Stage coulomb, before, has left it to this readback to tell that a contact is
 * bad. */
static int checked(const struct world *w, int status)
{
    bool bad = gpu_queue_bad(w->device->gpu);
    return status == DRAPE_OK && bad ? (int)DRAPE_EARG : status;
}

int gpu_systems_set_up(struct world *w, struct joint *s)
{
    const struct joint_system all = systems_of(w, s);
    return gpu_joint_set_up(&all);
}

int gpu_systems_measure(struct world *w, struct joint *s, const vec *r,
                        real *value)
{
    const struct joint_system all = systems_of(w, s);
    return checked(w, gpu_joint_measure(&all, r, value));
}

int gpu_systems_joint(struct world *w, struct joint *s)
{
    const struct joint_system all = systems_of(w, s);
    return checked(w, gpu_joint(&all));
}
