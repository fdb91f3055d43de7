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

/* How many calls of these functions succeed before all fail, how many queries
 * find a place beyond all numbers, and whether the count of intersecting pairs
 * fails, which is the last that a step does. */
static int left, beyond;
static bool uncounted;

static bool fails(void)
{
    return left-- <= 0;
}

static int motion(struct gpu *on, struct sheet *s)
{
    return fails() ? DRAPE_ENOMEM : backend_ref.motion(on, s);
}

static int coulomb(struct gpu *on, struct coulomb *s)
{
    return fails() ? DRAPE_ENOMEM : backend_ref.coulomb(on, s);
}

static int joint(struct world *w, struct joint *s)
{
    return fails() ? DRAPE_ENOMEM : backend_ref.joint_solve(w, s);
}

static int retain(struct gpu *on, struct retain *s)
{
    return fails() ? DRAPE_ENOMEM : backend_ref.retain(on, s);
}

static int audit(struct gpu *on, struct audit *s)
{
    return uncounted ? DRAPE_ENOMEM : backend_ref.audit(on, s);
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
    failing.joint_solve = joint;
    failing.retain = retain;
    failing.audit = audit;
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
        backend_ref.motion_energy(w->on, s, w->x0 + s->first, w->v0 + s->first,
                                  e);
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
    uint64_t start = scene_hash(world);
    EXPECT(recall_save(world, &before));
    for (int n = 0; n < 3 && !*done; n++) {
        beyond = n == 0 ? INT_MAX : 0;
        left = n != 1 ? INT_MAX : k % 5;
        uncounted = n == 2;
        int status = drape_step(world, r);
        left = INT_MAX;
        beyond = 0;
        uncounted = false;
        *done = status == DRAPE_OK && !(r->outcome & DRAPE_DIVERGED);
        if (*done)
            break;
        const char *failed = status ? NULL : check_books(world, r);
        if (failed)
            return failed;
        EXPECT(status == DRAPE_OK || status == DRAPE_ENOMEM);
        EXPECT(status || (r->step == k && r->time == k * world->world->def.dt));
        EXPECT(recall_save(world, &after) && recall_same(&before, &after));
        EXPECT(scene_hash(world) == start);
        EXPECT(drape_contacts(world, &list) != DRAPE_OK || list.n == 0);
        given_up[n]++;
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

/* A second slab cuts the cloth that rests, so that every step counts pairs. */
static void cross(struct ensemble *e, drape_obstacle slab[2])
{
    static double x[ENSEMBLE_BOX][3];
    slab[0] = slab[1] = e->d.obstacle;
    for (int p = 0; p < ENSEMBLE_BOX; p++) {
        x[p][0] = e->d.obstacle.x[p][0] + 4.14;
        x[p][1] = e->d.obstacle.x[p][1] + 0.2;
        x[p][2] = e->d.obstacle.x[p][2];
    }
    slab[1].x = (const double(*)[3])x;
    e->d.def.obstacles = slab;
    e->d.def.n_obstacles = 2;
    e->d.def.allow_intersecting = 1;
}

static const char *check(int how, bool crossed, int given_up[3])
{
    static struct ensemble e;
    drape_obstacle slab[2];
    drape_step_report r = {0}, s = {0};
    ensemble_make(&e, how);
    if (crossed)
        cross(&e, slab);
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
    static const int some[] = {0, 3, 4, 6, 4}; /* each method; the last cut */
    const char *failed = NULL;
    for (int k = 0; k < 5 && !failed; k++) {
        int given_up[3] = {0}; /* diverged, no memory, not counted */
        failed = check(some[k], k == 4, given_up);
        EXPECT(failed || (given_up[0] > 50 && given_up[1] > 25));
        EXPECT(failed || k < 4 || given_up[2] > 50);
    }
    return failed;
}
