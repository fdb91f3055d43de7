/* SPDX-License-Identifier: Apache-2.0 */
/* The last turn of contacts waits for the pairs that touch before it.
 * spec/contact/penalty.md §4.6 */
#include "ref/world/state.h"
#include "ref/world/step.h"
#include "tests/base/notes.h"
#include "tests/world/slab.h"
#include "tests/world/twin.h"

/* Of the turns of a step, those before its first detection of penetration. */
static int turns_before(const struct notes *a)
{
    int n = 0;
    for (size_t k = 0; k < a->n && strcmp(a->note[k].stage, "narrow"); k++)
        n += !strcmp(a->note[k].stage, "penalty");
    return n;
}

static bool looked_ahead(const struct notes *a)
{
    size_t k = 0;
    while (k < a->n && strcmp(a->note[k].stage, "ahead"))
        k++;
    return k < a->n;
}

/* How many steps waited, and how many of these had impacts that brought new
 * contacts; how many looked ahead (response.md §2.1). */
struct seen {
    int waited, joined, ahead;
};

/* Compares a step of one slice with what the slice before foretold. */
static const char *compare(const struct world *w, const struct notes *a,
                           const drape_step_report *r, enum nearness before,
                           struct seen *seen)
{
    const struct response *s = &w->response;
    int solves = w->couple.solves - w->couple.follows;
    if (looked_ahead(a)) { /* instead of waiting */
        EXPECT(s->waited && !s->waits && turns_before(a) == 1);
        seen->ahead++;
        return NULL;
    }
    EXPECT(r->outcome == 0 && s->waited <= (before == NEAR_IMPACTS));
    EXPECT((w->near == NEAR_IMPACTS) == (s->joined && s->contacts > 0));
    EXPECT(!s->waits);
    if (s->waited) {
        EXPECT(turns_before(a) == COUPLE_TURNS - 1);
        EXPECT(solves == COUPLE_TURNS);
        EXPECT(r->work.narrow <= r->rounds + 1);
    } else {
        EXPECT(r->work.narrow <= r->rounds);
        EXPECT(before < NEAR_IMPACTS || solves != COUPLE_TURNS);
    }
    seen->waited += s->waited;
    seen->joined += s->waited && s->joined;
    return NULL;
}

/* A sheet that falls on an edge and folds; with little friction it slips. */
static void fold(struct slab *d, double friction)
{
    slab_make(d, DRAPE_BW);
    d->cloth.u[0] = 0.28;
    d->cloth.u[1] = 0.96;
    d->cloth.origin[0] = 0;
    d->obstacle.motion = -1;
    d->cloth.material.friction = d->obstacle.friction = friction;
}

static const char *run(double friction, struct seen *seen)
{
    struct slab d;
    struct notes a = {0};
    struct arena arena;
    fold(&d, friction);
    d.def.trace = notes_take;
    d.def.trace_user = &a;
    struct world *w = slab_inner(&d.def, &arena);
    EXPECT(w);
    for (int k = 0; k < 40; k++) {
        drape_step_report r;
        enum nearness before = w->near;
        a.n = 0;
        EXPECT(step_advance(w, &r) == DRAPE_OK);
        const char *failed =
            r.work.tries == 1 ? compare(w, &a, &r, before, seen) : NULL;
        if (failed)
            return failed;
        ran(1);
    }
    arena_free(&arena);
    notes_free(&a);
    return NULL;
}

const char *test_world_waits(void)
{
    struct seen seen = {0};
    const char *failed = run(0.6, &seen);
    failed = failed ? failed : run(0.05, &seen);
    if (failed)
        return failed;
    EXPECT(seen.waited > 0 && seen.joined > 0);
    EXPECT(seen.ahead > 0);
    struct slab d;
    struct twin twin;
    fold(&d, 0.1);
    failed = twin_run(&d.def, 24, &twin);
    if (failed)
        return failed;
    EXPECT(twin.steps == 24);
    ran(twin.steps);
    return NULL;
}
