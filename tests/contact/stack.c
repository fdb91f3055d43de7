/* SPDX-License-Identifier: Apache-2.0 */
/* Sheets that lie on each other and on a slab: the work of a step by layers.
 * spec/contact/coulomb.md §3, spec/contact/lagrange.md */
#include "tests/world/slab.h"

enum { MOST = 4, STEPS = 24, FEW = 6 };

/* What the steps of a stack needed in all; contacts: of the last step. */
struct effort {
    int iterations, solves, rounds, slices;
    int64_t impacts, contacts;
};

/* Sheets on a slab at rest, each shifted a little, so that vertices lie over
 * edges and faces. They start just apart and settle. */
static const char *settle(int layers, int backend, int steps, struct effort *e)
{
    struct slab d;
    drape_cloth cloth[MOST];
    slab_small(&d, DRAPE_BW, 0.104);
    for (int k = 0; k < layers; k++) {
        cloth[k] = d.cloth;
        cloth[k].origin[0] += 0.003 * k;
        cloth[k].origin[1] += 0.0042 * k;
        cloth[k].origin[2] += 0.002 * k;
        cloth[k].material.thickness = 0.004;
    }
    d.obstacle.motion = -1;
    d.def.cloths = cloth;
    d.def.n_cloths = layers;
    d.def.backend = backend;
    drape_world *world = slab_world(&d);
    EXPECT(world);
    *e = (struct effort){0};
    for (int k = 0; k < steps; k++) {
        drape_step_report r;
        EXPECT(drape_step(world, &r) == DRAPE_OK && r.outcome == 0);
        e->iterations += r.iterations;
        e->solves += r.work.solves;
        e->rounds += r.rounds;
        e->slices += r.slices;
        e->impacts += r.impacts;
        e->contacts = r.contacts;
        ran(1);
    }
    drape_destroy(world);
    return NULL;
}

/* Upper bounds, of counts that are exact: the contacts' own matrix carries a
 * push through all layers in one solve, so that solves hardly grow with the
 * number of layers, and no step is cut or needs a second round. Contacts: flat
 * meshes of the same cells cross six times a cell, and each vertex has one
 * contact with the other mesh (proximity.md §3.4). */
const char *test_stack_layers(void)
{
    static const int some[] = {1, 2, MOST};
    const int particles = SLAB_SMALL * SLAB_SMALL;
    struct effort e[3], few[2];
    for (int k = 0; k < 3; k++) {
        const char *failed = settle(some[k], DRAPE_REF, STEPS, &e[k]);
        if (failed)
            return failed;
        EXPECT(e[k].rounds <= STEPS && e[k].slices == STEPS);
        EXPECT(e[k].solves <= 3 * STEPS && e[k].impacts == 0);
        EXPECT(e[k].contacts <= (2 + 8 * (some[k] - 1)) * particles);
    }
    EXPECT(e[0].iterations <= 4 * STEPS);
    EXPECT(e[1].iterations <= 12 * STEPS);
    EXPECT(e[2].iterations <= 24 * STEPS);
    for (int k = 0; k < 2; k++) { /* an emulated device is slow */
        const char *failed = settle(2, k ? DRAPE_GPU : DRAPE_REF, FEW, &few[k]);
        if (failed)
            return failed;
    }
    EXPECT(few[0].contacts > 0 && !memcmp(&few[0], &few[1], sizeof few[0]));
    return NULL;
}
