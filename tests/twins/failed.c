/* SPDX-License-Identifier: Apache-2.0 */
/* A world in which steps fail before they succeed, beside one in which none
 * fails; and the energies that steps report. spec/world/step.md §7, §11 */
#include <limits.h>

#include "ref/api/handle.h"
#include "ref/sleep/rest.h"
#include "ref/world/collide.h"
#include "tests/twins/ensemble.h"
#include "tests/world/recall.h"
#include "tests/world/scene.h"

/* How many calls of these functions succeed before all fail, and how many
 * queries find a place beyond all numbers. */
static int left, beyond;

static bool fails(void)
{
    return left-- <= 0;
}

static int motion(void *on, struct sheet *s)
{
    return fails() ? DRAPE_ENOMEM : backend_ref.motion(on, s);
}

static int coulomb(void *on, struct coulomb *s)
{
    return fails() ? DRAPE_ENOMEM : backend_ref.coulomb(on, s);
}

static int joint(struct world *w, struct joint *s)
{
    return fails() ? DRAPE_ENOMEM : backend_ref.joint(w, s);
}

static int retain(void *on, struct retain *s)
{
    return fails() ? DRAPE_ENOMEM : backend_ref.retain(on, s);
}

static int broad(void *user, const uint8_t *touched, struct pairs *out)
{
    if (beyond > 0) {
        beyond--;
        return DRAPE_EDATA;
    }
    return fails() ? DRAPE_ENOMEM : collide_broad(user, touched, out);
}

static void make_failing(struct world *w)
{
    static struct backend failing;
    failing = backend_ref;
    failing.motion = motion;
    failing.coulomb = coulomb;
    failing.joint = joint;
    failing.retain = retain;
    w->run = &failing;
    w->response.broad = broad;
}

/* §11, sleep.md §3: the energies of a report are those of the state that the
 * step left, whether cloths sleep, the step failed, or somebody has changed
 * what energies depend on. The stage energy finds them anew. */
static const char *check_books(drape_world *world, const drape_step_report *r)
{
    struct world *w = world->world;
    double sum[3] = {0};
    for (int k = 0; k < w->def.n_cloths; k++) {
        struct sheet *s = &w->sheet[k];
        double e[3];
        backend_ref.energy(w->on, s, w->x0 + s->first, w->v0 + s->first, e);
        for (int j = 0; j < 3; j++)
            sum[j] += e[j];
    }
    EXPECT(r->kinetic == sum[0]);
    EXPECT(r->elastic == sum[1]);
    EXPECT(r->potential == sum[2]);
    return NULL;
}

/* Tries step k of a world some times in vain. Returns whether a try succeeded
 * all the same, as nothing that fails was needed; *r: its report. */
static const char *try(drape_world *world, int k, drape_step_report *r,
                       bool *done, int *given_up)
{
    static struct recall before, after;
    drape_contact_list list;
    int asleep = world->world->sleep->n;
    uint64_t start = scene_hash(world);
    EXPECT(recall_save(world, &before));
    for (int n = 0; n < 2 && !*done; n++) {
        beyond = n == 0 ? INT_MAX : 0;
        left = n == 0 ? INT_MAX : k % 5;
        int status = drape_step(world, r);
        left = INT_MAX;
        beyond = 0;
        *done = status == DRAPE_OK && !(r->outcome & DRAPE_DIVERGED);
        if (*done)
            break;
        const char *failed = status ? NULL : check_books(world, r);
        if (failed)
            return failed;
        EXPECT(status == DRAPE_OK || status == DRAPE_ENOMEM);
        EXPECT(status || (r->step == k && r->time == k * world->world->def.dt));
        /* known: a cloth that a try in vain has woken stays awake */
        bool woke = world->world->sleep->n < asleep;
        EXPECT(woke ||
               (recall_save(world, &after) && recall_same(&before, &after)));
        EXPECT(scene_hash(world) == start);
        EXPECT(drape_contacts(world, &list) != DRAPE_OK || list.n == 0);
        given_up[n == 0]++;
    }
    return NULL;
}

/* A report without the counts of slices that were taken again: a step that was
 * tried before need not take a slice again to wake a cloth. */
static drape_step_report stripped(const drape_step_report *r)
{
    drape_step_report a = *r;
    memset(&a.work, 0, sizeof a.work);
    a.iterations = a.rounds = 0;
    a.candidates = 0;
    return a;
}

static const char *check(int how, int given_up[2])
{
    static struct ensemble e;
    drape_step_report r = {0}, s = {0};
    ensemble_make(&e, how);
    drape_world *a = slab_world(&e.d), *b = slab_world(&e.d);
    EXPECT(a && b);
    make_failing(b->world);
    left = INT_MAX;
    for (int k = 0; k < ENSEMBLE_STEPS; k++) {
        bool done = false;
        EXPECT(ensemble_call(a, &e, k) == DRAPE_OK);
        EXPECT(ensemble_call(b, &e, k) == DRAPE_OK);
        memset(&r, 0, sizeof r);
        memset(&s, 0, sizeof s);
        EXPECT(drape_step(a, &r) == DRAPE_OK);
        const char *failed = check_books(a, &r);
        failed = failed ? failed : try(b, k, &s, &done, given_up);
        if (failed)
            return failed;
        EXPECT(done || drape_step(b, &s) == DRAPE_OK);
        EXPECT(scene_hash(a) == scene_hash(b));
        EXPECT(ensemble_same(stripped(&r), stripped(&s)));
        ran(1);
    }
    drape_destroy(a);
    drape_destroy(b);
    return NULL;
}

const char *test_failed_before(void)
{
    const char *failed = NULL;
    for (int how = 0; how < ENSEMBLE_HOWS && !failed; how++) {
        int given_up[2] = {0, 0}; /* steps without memory, and that diverged */
        failed = check(how, given_up);
        EXPECT(failed || (given_up[0] > 25 && given_up[1] > 50));
    }
    return failed;
}
