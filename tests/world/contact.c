/* SPDX-License-Identifier: Apache-2.0 */
/* Contact across whole steps: friction of a pair, the press of a slice, and the
 * past of Choi–Ko. spec/contact/warm.md, spec/cloth/implicit.md §4 */
#include "ref/cloth/implicit.h"
#include "ref/world/state.h"
#include "ref/world/step.h"
#include "tests/solve/system.h"
#include "tests/world/scene.h"
#include "tests/world/slab.h"

enum { SIDE = SLAB_SMALL, COUNT = SIDE * SIDE };

/* proximity.md: a pair has the larger friction of its two surfaces. Runs a
 * sheet on a slope; returns the hash after some steps, 0 if a step fails. */
static uint64_t slide(int integrator, double cloth, double slab)
{
    struct slab d;
    slab_small(&d, integrator, 0.1039);
    d.def.dt = 0x1p-8;
    d.obstacle.motion = -1;
    d.cloth.material.friction = cloth;
    d.obstacle.friction = slab;
    d.def.gravity[0] = 5.886; /* 9.81 on a slope of 3/4 */
    d.def.gravity[1] = -7.848;
    drape_world *world = slab_world(&d);
    int status = world ? DRAPE_OK : DRAPE_EARG;
    for (int step = 0; step < 5 && status == DRAPE_OK; step++)
        status = drape_step(world, NULL);
    uint64_t hash = status == DRAPE_OK ? scene_hash(world) : 0;
    drape_destroy(world);
    return hash;
}

const char *test_world_friction(void)
{
    static const int some[] = {DRAPE_VERLET, DRAPE_BW, DRAPE_CK};
    for (int k = 0; k < 3; k++) {
        uint64_t both = slide(some[k], 0.5, 0.5);
        EXPECT(both && slide(some[k], 0.5, 0.125) == both);
        EXPECT(slide(some[k], 0, 0.5) == both);
        EXPECT(slide(some[k], 0.5, 0) == both);
        EXPECT(slide(some[k], 0.125, 0) != both);
        ran(1);
    }
    return NULL;
}

/* warm.md §4: a slice that the fail-safe ended leaves no press */

static bool presses(const struct world *w)
{
    for (int64_t i = 0; i < w->nc; i++)
        if (vec_dot(w->press[i], w->press[i]) > 0)
            return true;
    return false;
}

const char *test_world_press(void)
{
    int failed = 0, held = 0;
    for (int rounds = 0; rounds <= 16; rounds += 4) {
        static double v[COUNT][3];
        struct slab d;
        struct arena arena;
        drape_step_report r;
        slab_small(&d, DRAPE_BW, 0.103);
        for (int k = 0; k < 3 * COUNT; k++)
            v[k / 3][k % 3] = 5 * noise_of((uint64_t)k);
        d.cloth.velocity = (const double(*)[3])v;
        d.cloth.material.stretch = 0.1; /* so soft that the sheet crumples */
        d.cloth.material.shear = 0.02;
        d.cloth.material.bend = 0;
        d.def.max_rounds = rounds;
        d.def.max_slices = 1;
        struct world *w = slab_inner(&d.def, &arena);
        EXPECT(w);
        for (int step = 0; step < 12; step++) {
            EXPECT(step_advance(w, &r) == DRAPE_OK);
            bool bad = slice_failed(r.outcome);
            EXPECT(w->pressed == (!bad && r.contacts > 0));
            EXPECT(w->pressed || !presses(w));
            EXPECT((w->near >= NEAR_CONTACTS) == (r.contacts > 0));
            failed += bad && r.contacts > 0;
            held += w->pressed && presses(w);
            ran(1);
        }
        arena_free(&arena);
    }
    EXPECT(failed > 0 && held > 0);
    return NULL;
}

/* implicit.md §4: Choi–Ko remembers the motion without contact. */
const char *test_world_past(void)
{
    static vec x0[COUNT], v0[COUNT], xp[COUNT], vp[COUNT];
    struct slab d;
    struct arena arena;
    drape_step_report r;
    int parted = 0;
    slab_small(&d, DRAPE_CK, 0.1035);
    d.obstacle.motion = -1;
    struct world *w = slab_inner(&d.def, &arena);
    EXPECT(w && w->nc == COUNT);
    for (int step = 0; step < 8; step++) {
        memcpy(x0, w->x0, sizeof x0);
        memcpy(v0, w->v0, sizeof v0);
        EXPECT(step_advance(w, &r) == DRAPE_OK && r.slices == 1);
        struct history h = {.count = COUNT,
                            .x0 = x0,
                            .v0 = v0,
                            .x1 = w->free_x,
                            .v1 = w->free_v,
                            .x = w->x0,
                            .v = w->v0,
                            .dt = (real)w->dt,
                            .xp = xp,
                            .vp = vp};
        EXPECT(ref_history(&h) == DRAPE_OK);
        EXPECT(!memcmp(xp, w->past_x, sizeof xp));
        EXPECT(!memcmp(vp, w->past_v, sizeof vp));
        parted += memcmp(w->free_v, w->v0, sizeof v0) != 0;
        ran(1);
    }
    EXPECT(parted > 0); /* contact did change the motion */
    arena_free(&arena);
    return NULL;
}
