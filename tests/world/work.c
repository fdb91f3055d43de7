/* SPDX-License-Identifier: Apache-2.0 */
/* The work counters of a step's report are true. spec/world/step.md §10 */
#include "tests/base/notes.h"
#include "tests/world/recall.h"
#include "tests/world/slab.h"

enum { SIDE = 12 };

/* How often a stage ran in the traced steps. */
static int times(const struct notes *a, const char *stage)
{
    int n = 0;
    for (size_t k = 0; k < a->n; k++)
        n += !strcmp(a->note[k].stage, stage);
    return n;
}

/* The report's counts agree with the trace, which the stages write themselves.
 */
static const char *agree(const struct notes *a, const drape_step_report *r)
{
    const drape_work *w = &r->work;
    EXPECT(times(a, "pcg") + times(a, "joint") == w->solves);
    int walks = times(a, "walk"), asked = times(a, "extent");
    EXPECT(times(a, "refit") == walks && walks <= w->queries);
    EXPECT(w->queries <= walks + asked && (w->boxes > 0) == (walks > 0));
    EXPECT(times(a, "narrow") == w->narrow);
    /* once at the start, and wherever the loop looks for pairs that arrive */
    int looked = times(a, "proximity");
    EXPECT(looked > 0 || w->near == 0);
    EXPECT(looked <= w->tries + w->solves + w->narrow);
    EXPECT(w->narrow <= r->rounds + w->solves + w->tries); /* lagrange.md §2 */
    EXPECT((w->narrow > 0) == (r->candidates > 0));
    EXPECT(w->tries >= r->slices && w->later <= r->candidates);
    EXPECT(w->later == 0 || r->rounds > r->slices);
    return NULL;
}

static const char *step(drape_world *world, struct notes *a,
                        drape_step_report *r)
{
    a->n = 0;
    EXPECT(drape_step(world, r) == DRAPE_OK);
    return agree(a, r);
}

/* Makes a slab and a sheet, small enough for many steps. */
static drape_world *small_world(struct slab *d, struct notes *a, double height)
{
    d->cloth.m = d->cloth.n = SIDE;
    d->cloth.width = d->cloth.height = 0.22;
    d->cloth.origin[0] = d->cloth.origin[2] = -0.11;
    d->cloth.origin[1] = height;
    d->def.trace = notes_take;
    d->def.trace_user = a;
    return slab_world(d);
}

/* §10: for a body far away or at rest, boxes, the narrow phase and the rest of
 * the broad phase are skipped; one cheap test runs. */
static const char *far_away(int integrator, bool moves)
{
    struct slab d;
    struct notes a = {0};
    drape_step_report r;
    slab_make(&d, integrator);
    d.obstacle.motion = moves ? 0 : -1;
    if (integrator < DRAPE_BW)
        d.def.dt = 1e-4;
    drape_world *world = small_world(&d, &a, 2);
    EXPECT(world);
    for (int k = 0; k < 3; k++) {
        const char *failed = step(world, &a, &r);
        if (failed)
            return failed;
        const drape_work *w = &r.work;
        EXPECT(w->tries == 1 && w->solves == (integrator >= DRAPE_BW));
        EXPECT(w->queries == 1 && r.rounds == 0);
        EXPECT(!w->narrow && !w->near && !w->later && !r.candidates);
        EXPECT(times(&a, "features") == 0 && times(&a, "impacts") == 0);
        /* a static mesh and a flat sheet need no walk inside themselves */
        EXPECT(times(&a, "extent") == !moves);
        EXPECT((w->boxes == 0) == !moves && (w->boxes_kept == 0) == moves);
        EXPECT(w->walked <= 4 && w->cleared == moves);
    }
    drape_destroy(world);
    notes_free(&a);
    return NULL;
}

/* A sheet falls on the slab: every counter becomes positive. Where contacts are
 * solved with the cloth the rounds after it have next to nothing to do. */
static const char *falls(int integrator, int response)
{
    struct slab d;
    struct notes a = {0};
    drape_step_report r;
    drape_work all = {0};
    int64_t rounds = 0;
    int quiet = 0;
    bool solves = response == DRAPE_SOLVE;
    slab_make(&d, integrator);
    d.def.response = response;
    d.obstacle.motion = -1;
    drape_world *world = small_world(&d, &a, 0.15);
    EXPECT(world);
    for (int k = 0; k < 12; k++) {
        const char *failed = step(world, &a, &r);
        if (failed)
            return failed;
        rounds += r.rounds;
        /* the boxes of the slab, which stands still, are made once */
        if (k > 0 && r.rounds == 1 && r.impacts == 0) {
            EXPECT(r.work.boxes > 0 && r.work.boxes_kept > 0);
            EXPECT(r.work.boxes_kept % r.work.queries == 0);
            quiet++;
        }
        all.solves += r.work.solves;
        all.narrow += r.work.narrow;
        all.near += r.work.near;
        all.cleared += r.work.cleared;
        all.later += r.work.later;
    }
    EXPECT(quiet > 0);
    EXPECT(all.solves >= 12 && all.near > 0 && all.cleared > 0);
    EXPECT(solves || integrator == DRAPE_CK || all.later > 0);
    EXPECT(all.narrow > 0 && all.narrow <= rounds + solves * all.solves);
    drape_destroy(world);
    notes_free(&a);
    return NULL;
}

/* A sheet with all particles pinned falls asleep; then all counters are 0. */
static const char *sleeps(void)
{
    static const drape_work none = {0};
    drape_pin pin[SIDE * SIDE];
    struct slab d;
    struct notes a = {0};
    drape_step_report r = {0};
    slab_make(&d, DRAPE_BW);
    for (int k = 0; k < SIDE * SIDE; k++)
        pin[k] = (drape_pin){k % SIDE, k / SIDE, -1};
    d.cloth.pins = pin;
    d.cloth.n_pins = SIDE * SIDE;
    d.obstacle.motion = -1;
    drape_world *world = small_world(&d, &a, 1);
    EXPECT(world);
    for (int k = 0; k < 32; k++) {
        const char *failed = step(world, &a, &r);
        if (failed)
            return failed;
        EXPECT((r.outcome == DRAPE_ASLEEP) == (k >= 30));
        EXPECT((memcmp(&r.work, &none, sizeof none) == 0) == (k >= 30));
    }
    EXPECT(a.n == 0);
    drape_destroy(world);
    notes_free(&a);
    return NULL;
}

const char *test_world_work(void)
{
    const char *failed = sleeps();
    for (int k = 0; k < 4 && !failed; k++)
        failed = far_away(k / 2 ? DRAPE_BW : DRAPE_VERLET, k % 2);
    for (int m = DRAPE_BW; m <= DRAPE_BDF2 && !failed; m++)
        failed = falls(m, DRAPE_SOLVE);
    for (int m = DRAPE_BW; m <= DRAPE_BDF2 && !failed; m++)
        failed = falls(m, DRAPE_IMPULSES);
    ran(11);
    return failed;
}

/* A step without a report has the same bits. */
const char *test_world_unread(void)
{
    static struct recall state[2];
    for (int integrator = DRAPE_VERLET; integrator <= DRAPE_CK; integrator++) {
        struct slab d;
        drape_step_report r;
        slab_small(&d, integrator, 0.105);
        d.obstacle.motion = -1;
        drape_world *a = slab_world(&d), *b = slab_world(&d);
        EXPECT(a && b);
        for (int step = 0; step < 12; step++) {
            EXPECT(drape_step(a, &r) == DRAPE_OK && !drape_step(b, NULL));
            EXPECT(recall_save(a, &state[0]) && recall_save(b, &state[1]));
            EXPECT(recall_same(&state[0], &state[1]));
            ran(1);
        }
        drape_destroy(a);
        drape_destroy(b);
    }
    return NULL;
}
