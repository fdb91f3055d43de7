/* SPDX-License-Identifier: Apache-2.0 */
/* The tests before collision: whether anything is near, and how far two bodies
 * move towards each other. spec/world/step.md §3, §7.2 */
#include "ref/world/state.h"
#include "ref/world/step.h"
#include "tests/world/slab.h"

enum { SIDE = SLAB_SMALL, COUNT = SIDE * SIDE };

/* step.md §3: the early test whether anything is near changes no bit */

/* Runs a sheet that starts `above` the slab with `speed` with the early test,
 * and without it (as if the slice before always had a candidate). */
static const char *check_near(struct slab *d, double above, double speed)
{
    static double v[COUNT][3];
    struct arena arena[2];
    struct world *w[2];
    drape_step_report r[2];
    for (int p = 0; p < COUNT; p++)
        v[p][1] = -speed;
    d->cloth.velocity = (const double(*)[3])v;
    d->cloth.origin[1] = 0.1 + above;
    d->def.gravity[1] = 0;
    for (int k = 0; k < 2; k++)
        w[k] = slab_inner(&d->def, &arena[k]);
    EXPECT(w[0] && w[1]);
    size_t bytes = (size_t)w[0]->nv * sizeof(vec);
    for (int step = 0; step < 3; step++) {
        if (w[1]->nearness == NEAR_NONE)
            w[1]->nearness = NEAR_PAIRS;
        for (int k = 0; k < 2; k++)
            EXPECT(step_advance(w[k], &r[k]) == DRAPE_OK);
        EXPECT(!memcmp(w[0]->x0, w[1]->x0, bytes));
        EXPECT(!memcmp(w[0]->v0, w[1]->v0, bytes));
        EXPECT(r[0].contacts == r[1].contacts && r[0].slices == r[1].slices);
        ran(1);
    }
    for (int k = 0; k < 2; k++)
        arena_free(&arena[k]);
    return NULL;
}

const char *test_world_near(void)
{
    static const double height[] = {0.0035, 0.0045, 0.3};
    static const double speed[] = {0, 1, 24};
    const char *failed = NULL;
    for (int k = 0; k < 3 * 3 * 3 && !failed; k++) {
        struct slab d;
        int way = k / 3 % 3;
        slab_small(&d, k % 3 == 0 ? DRAPE_VERLET : DRAPE_BW, 0.2);
        d.obstacle.motion = k % 3 == 1 ? 0 : -1;
        failed = check_near(&d, height[k / 9], speed[way]);
    }
    return failed;
}

/* step.md §7.2: the displacements of two moving bodies are added. Two parallel,
 * oblique sheets, whose boxes all overlap, pass each other by `first` and
 * `second` cells a step. Returns the slices of the first step, or 0 if it
 * fails.
 */
static int pass(int integrator, double first, double second)
{
    enum { M = 3 };
    static double v[2][M * M][3];
    static drape_cloth cloth[2];
    const double half = 0.70710678118654752;
    struct slab d;
    drape_step_report r;
    slab_make(&d, integrator);
    d.def.dt = integrator < DRAPE_BW ? 1e-3 : 1.0 / 60;
    d.def.response = DRAPE_IMPULSES;
    for (int k = 0; k < 2; k++) {
        double speed = (k ? -second : first) * 0.1 / d.def.dt;
        cloth[k] = d.cloth;
        cloth[k].m = cloth[k].n = M;
        cloth[k].width = cloth[k].height = 0.2;
        cloth[k].u[0] = cloth[k].u[1] = half;
        cloth[k].origin[0] = k ? 0.03 : 0;
        for (int p = 0; p < M * M; p++)
            v[k][p][0] = v[k][p][1] = speed * half;
        cloth[k].velocity = (const double(*)[3])v[k];
    }
    d.def.gravity[1] = 0;
    d.def.cloths = cloth;
    d.def.n_cloths = 2;
    d.def.n_obstacles = 0;
    drape_world *world = slab_world(&d);
    bool good = world && drape_step(world, &r) == DRAPE_OK && r.outcome == 0;
    drape_destroy(world);
    return good ? r.slices : 0;
}

const char *test_world_meeting(void)
{
    for (int k = 0; k < 2; k++) {
        int integrator = k ? DRAPE_BW : DRAPE_VERLET;
        const double most = 4; /* cells, limit of relative displacement */
        EXPECT(pass(integrator, 0.49 * most, 0.49 * most) == 1);
        EXPECT(pass(integrator, 0.51 * most, 0.51 * most) == 2);
        EXPECT(pass(integrator, 0.98 * most, 0) == 1);
        EXPECT(pass(integrator, 1.02 * most, 0) == 2);
        EXPECT(pass(integrator, 0.3 * most, 0.72 * most) == 2);
        EXPECT(pass(integrator, 2.04 * most, 0) > 2);
        EXPECT(pass(integrator, 3 * most, -3 * most) == 1); /* together */
        ran(7);
    }
    return NULL;
}
