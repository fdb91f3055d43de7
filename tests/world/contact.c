/* SPDX-License-Identifier: Apache-2.0 */
/* Contact across whole steps: friction of a pair, what contacts carry on, and
 * the past of Choi–Ko. spec/contact/carry.md, spec/cloth/implicit.md §4 */
#include "ref/cloth/implicit.h"
#include "ref/contact/carry.h"
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

/* carry.md §2: a slice leaves what its contacts pressed with, by key, for the
 * next, and nothing where nothing met; §1: a contact that presses at rest goes
 * on with it. */
static const char *check_kept(const struct world *w, const drape_step_report *r,
                              int *pressed)
{
    const struct lagrange *a = &w->lagrange;
    const struct kept *kept = a->kept[0].data;
    EXPECT(a->n_kept[0] == (a->solved ? w->response.n_solved : 0));
    EXPECT((w->nearness >= NEAR_CONTACTS) ==
           (r->contacts > 0 || w->response.active > 0));
    for (int64_t k = 0; k < a->n_kept[0]; k++) {
        vec t = kept[k].lambda_t;
        EXPECT(kept[k].lambda >= 0 && (kept[k].lambda > 0 || t.x == 0));
        EXPECT(k == 0 || kept[k - 1].hi < kept[k].hi ||
               (kept[k - 1].hi == kept[k].hi && kept[k - 1].lo < kept[k].lo));
        *pressed += kept[k].lambda > 0;
    }
    return NULL;
}

const char *test_world_kept(void)
{
    const char *failed = NULL;
    int pressed = 0, gone = 0;
    for (int k = 0; k < 2 && !failed; k++) {
        struct slab d;
        struct arena arena;
        drape_step_report r;
        slab_small(&d, DRAPE_BW, 0.1035);
        d.def.gravity[1] = k ? 9.81 : -9.81;
        d.obstacle.motion = -1;
        struct world *w = slab_inner(&d.def, &arena);
        EXPECT(w);
        for (int step = 0; step < 16 && !failed; step++) {
            EXPECT(step_advance(w, &r) == DRAPE_OK);
            failed = check_kept(w, &r, &pressed);
            gone += step > 0 && w->nearness == NEAR_NONE;
            ran(1);
        }
        arena_free(&arena);
    }
    EXPECT(failed || (pressed > 0 && gone > 0));
    return failed;
}

/* implicit.md §4: what contacts struck is a jump at the start of the slice, for
 * the past of Choi–Ko. */
const char *test_world_past(void)
{
    static vec x0[COUNT], v0[COUNT], xp[COUNT], vp[COUNT];
    struct slab d;
    struct arena arena;
    drape_step_report r;
    int parted = 0;
    slab_small(&d, DRAPE_CK, 0.115); /* it falls on the slab */
    d.obstacle.motion = -1;
    struct world *w = slab_inner(&d.def, &arena);
    EXPECT(w && w->nc == COUNT);
    for (int step = 0; step < 8; step++) {
        bool past = w->past == 1;
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
                            .n_jump = w->lagrange.struck ? COUNT : 0,
                            .jump = w->lagrange.jump,
                            .part = past ? R(2.0) / 3 : 1,
                            .dt = (real)w->dt,
                            .xp = xp,
                            .vp = vp};
        EXPECT(ref_history(&h) == DRAPE_OK);
        EXPECT(!memcmp(xp, w->past_x, sizeof xp));
        EXPECT(!memcmp(vp, w->past_v, sizeof vp));
        for (int k = 0; k < COUNT && w->lagrange.struck; k++)
            parted += vec_length(w->lagrange.jump[k]) > R(1e-3);
        ran(1);
    }
    EXPECT(parted > 0); /* contacts did strike */
    arena_free(&arena);
    return NULL;
}
