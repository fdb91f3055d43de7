/* SPDX-License-Identifier: Apache-2.0 */
/* A checkpoint is the whole state: into whatever state of a world it is loaded,
 * the run continues with the same bits. spec/world/step.md */
#include <stdlib.h>

#include "ref/world/step.h"
#include "tests/world/recall.h"
#include "tests/world/slab.h"

enum { STEPS = 36 };

/* A checkpoint before each step of a run, and the report of each step. */
struct run {
    struct recall before[STEPS];
    drape_step_report report[STEPS];
};

/* Whether two reports are equal but for times and launches. */
static bool same_report(drape_step_report a, drape_step_report b)
{
    memset(a.seconds, 0, sizeof a.seconds);
    memset(b.seconds, 0, sizeof b.seconds);
    return !memcmp(&a, &b, sizeof a);
}

/* Makes scene k: a sheet on the slab, thrown at it, or at rest in empty space;
 * the wind changes during the run. */
static void make(struct slab *d, int k)
{
    static const double still[2][3] = {{0}};
    static double v[16 * 16][3];
    slab_make(d, k == 2 ? DRAPE_VERLET : k % 2 ? DRAPE_CK : DRAPE_BW);
    d->cloth.m = d->cloth.n = 16;
    d->cloth.width = d->cloth.height = 15.0 / 64;
    d->cloth.origin[0] = d->cloth.origin[2] = -0.125;
    d->cloth.origin[1] = 0.1041;
    for (int p = 0; p < 16 * 16; p++)
        v[p][1] = -2 + 0.1 * (p % 3);
    d->cloth.velocity = (const double(*)[3])v;
    d->def.dt = k == 2 ? 1e-3 : 1.0 / 60;
    d->def.max_rounds = k == 1 ? 1 : 16;
    d->def.wind = (drape_wind){
        .velocity = {0, 0, 0}, .density = 1.2, .drag = 1, .lift = 0.3};
    if (k < 3)
        return;
    d->def.gravity[1] = 0; /* the scene falls asleep */
    d->def.wind.density = 0;
    d->cloth.velocity = NULL;
    d->cloth.origin[1] = 0.375;
    d->motion.position = still;
}

static drape_step_report step(drape_world *world, bool windy, int k)
{
    drape_step_report r;
    const drape_wind gale = {
        .velocity = {1 + k, 0, 2}, .density = 1.2, .drag = 1, .lift = 0.3};
    if (windy && k % 4 == 0)
        drape_set_wind(world, &gale);
    memset(&r, 0, sizeof r);
    if (drape_step(world, &r) != DRAPE_OK)
        r.step = -1;
    return r;
}

static const char *record(drape_world *world, bool windy, int n, struct run *a)
{
    for (int k = 0; k < n; k++) {
        EXPECT(recall_save(world, &a->before[k]));
        a->report[k] = step(world, windy, k);
        EXPECT(a->report[k].step == k + 1);
    }
    return NULL;
}

/* Loads the checkpoint before step k into a world in another state and runs to
 * the end. */
static const char *resume(drape_world *world, bool windy, int n, int k,
                          struct run *a)
{
    static struct recall now;
    EXPECT(recall_load(world, &a->before[k]) == DRAPE_OK);
    for (int i = k; i < n && i < k + 3; i++) {
        EXPECT(recall_save(world, &now));
        EXPECT(recall_same(&now, &a->before[i]));
        EXPECT(same_report(step(world, windy, i), a->report[i]));
        ran(1);
    }
    return NULL;
}

const char *test_checkpoint_anywhere(void)
{
    static struct run a;
    const char *failed = NULL;
    for (int k = 0; k < 5 && !failed; k++) {
        struct slab d;
        make(&d, k);
        bool windy = k < 3;
        int n = windy ? 14 : STEPS;
        drape_world *world = slab_world(&d), *other = slab_world(&d);
        EXPECT(world && other);
        failed = record(world, windy, n, &a);
        EXPECT(failed || windy || a.report[n - 1].outcome == DRAPE_ASLEEP);
        for (int i = 0; i < n && !failed; i++)
            failed = resume(other, windy, n, 5 * i % n, &a);
        drape_destroy(world);
        drape_destroy(other);
    }
    return failed;
}

/* dynamics.md §3: the energies that a cloth's steps are watched by go on from a
 * checkpoint; only a step that diverges would show that they were lost. */
const char *test_checkpoint_watch(void)
{
    static struct recall r;
    struct slab d;
    struct arena arena[2];
    struct world *w[2];
    drape_step_report report;
    slab_small(&d, DRAPE_BW, 0.103);
    drape_cloth cloth[2] = {d.cloth, d.cloth};
    cloth[1].origin[1] = 0.25;
    d.def.cloths = cloth;
    d.def.n_cloths = 2;
    for (int k = 0; k < 2; k++) {
        w[k] = slab_inner(&d.def, &arena[k]);
        EXPECT(w[k]);
    }
    for (int k = 0; k < 4; k++)
        EXPECT(step_advance(w[0], &report) == DRAPE_OK);
    w[0]->watch[1][1] = 0.5; /* a step that keeps to the law adds no surplus */
    EXPECT(recall_save_inner(w[0], &r));
    EXPECT(recall_load_inner(w[1], &r) == DRAPE_OK);
    for (int k = 0; k < 2; k++) {
        EXPECT(w[0]->watch[k][0] > 0);
        EXPECT(w[1]->watch[k][0] == w[0]->watch[k][0]);
        EXPECT(w[1]->watch[k][1] == w[0]->watch[k][1]);
        ran(1);
    }
    arena_free(&arena[0]);
    arena_free(&arena[1]);
    return NULL;
}
