/* SPDX-License-Identifier: Apache-2.0 */
/* A world in which cloths sleep beside the same world in which none does.
 * spec/sleep/sleep.md */
#include "tests/twins/ensemble.h"
#include "tests/world/scene.h"

/* Two worlds, of which the second may not sleep. */
static const char *make_both(struct ensemble *e, drape_world *world[2])
{
    for (int k = 0; k < 2; k++) {
        e->d.def.sleep = !k;
        world[k] = slab_world(&e->d);
        EXPECT(world[k]);
    }
    return NULL;
}

/* §3: a cloth that sleeps where it would stand still all the same changes no
 * bit of anything: states, energies and contacts. The cloth that slides has no
 * friction, so that it never rests. */
static const char *check_still(int how, int *asleep, int *woke)
{
    static struct ensemble e;
    drape_world *world[2] = {NULL, NULL};
    drape_step_report r[2] = {{0}};
    ensemble_make(&e, how);
    e.cloth[ENSEMBLE_SLIDES].material.friction = e.d.obstacle.friction = 0;
    const char *failed = make_both(&e, world);
    for (int k = 0; k < ENSEMBLE_STEPS && !failed; k++) {
        int before = r[0].asleep;
        for (int j = 0; j < 2; j++) {
            EXPECT(ensemble_call(world[j], &e, k) == DRAPE_OK);
            EXPECT(drape_step(world[j], &r[j]) == DRAPE_OK);
        }
        EXPECT(r[1].asleep == 0 && r[0].outcome == r[1].outcome);
        EXPECT(scene_hash(world[0]) == scene_hash(world[1]));
        EXPECT(r[0].kinetic == r[1].kinetic && r[0].elastic == r[1].elastic);
        EXPECT(r[0].potential == r[1].potential);
        EXPECT(r[0].contacts == r[1].contacts && r[0].impacts == r[1].impacts);
        EXPECT(r[0].residual == r[1].residual && r[0].slices == r[1].slices);
        *asleep += r[0].asleep;
        *woke += r[0].asleep < before;
        ran(1);
    }
    drape_destroy(world[0]);
    drape_destroy(world[1]);
    return failed;
}

/* §3: the energies of a cloth that sleeps are those of its state now, also
 * where it slept before with others: its material changes while it sleeps.
 * Alone the world sleeps as a whole, and beside the cloth that is prescribed in
 * part.
 */
static const char *check_twice(bool alone)
{
    enum { CHANGES = 36, END = 72 };
    static struct ensemble e;
    drape_world *world[2] = {NULL, NULL};
    drape_step_report r[2];
    int asleep[2] = {0, 0};
    ensemble_make(&e, 0);
    e.d.def.cloths = e.cloth + ENSEMBLE_RESTS;
    e.d.def.n_cloths = alone ? 1 : 2;
    e.cloth[ENSEMBLE_THROWN] = e.cloth[ENSEMBLE_PRESCRIBED];
    drape_material m = e.cloth[ENSEMBLE_RESTS].material;
    m.density *= 2;
    m.stretch *= 3;
    const char *failed = make_both(&e, world);
    for (int k = 0; k < END && !failed; k++) {
        for (int j = 0; j < 2; j++) {
            EXPECT(k != CHANGES || !drape_set_material(world[j], 0, &m));
            EXPECT(drape_step(world[j], &r[j]) == DRAPE_OK);
        }
        EXPECT(r[0].kinetic == r[1].kinetic && r[0].elastic == r[1].elastic);
        EXPECT(r[0].potential == r[1].potential);
        EXPECT(!(r[0].outcome & DRAPE_ASLEEP) || (alone && r[0].asleep));
        asleep[k > CHANGES] += r[0].asleep;
        ran(1);
    }
    EXPECT(failed || (asleep[0] > 3 && asleep[1] > 3));
    drape_destroy(world[0]);
    drape_destroy(world[1]);
    return failed;
}

/* §1: a cloth that went a tenth of the thickness to and fro is tired when its
 * anchor is 100 steps old, not when it is back. */
static const char *check_swayed(void)
{
    static struct ensemble e;
    static double time[3], way[3][3];
    drape_step_report r = {.asleep = 0};
    int asleep = 0;
    ensemble_make(&e, 0);
    for (int k = 0; k < 3; k++)
        time[k] = (4 + 4 * k) * e.d.def.dt;
    way[1][2] = 0.101 * e.d.cloth.material.thickness;
    e.d.motion =
        (drape_motion){3, time, (const double(*)[3])way, NULL, {0, 0, 0}};
    for (int p = 0; p < ENSEMBLE_COUNT; p++)
        e.pin[p].motion = 0;
    e.d.def.cloths = e.cloth + ENSEMBLE_RESTS;
    e.d.def.n_cloths = 1;
    drape_world *world = slab_world(&e.d);
    EXPECT(world);
    for (; asleep < 120 && !r.asleep; asleep++)
        EXPECT(drape_step(world, &r) == DRAPE_OK);
    EXPECT(asleep > 100 && asleep < 105);
    drape_destroy(world);
    ran(1);
    return NULL;
}

/* The farthest that a particle of the cloth that slides is in one world from
 * where it is in the other. */
static double apart(drape_world *const world[2])
{
    static double x[2][ENSEMBLE_NV][3];
    double most = 0;
    for (int j = 0; j < 2; j++)
        drape_read(world[j], x[j], NULL);
    for (int p = 0; p < ENSEMBLE_COUNT; p++) {
        double d = 0;
        for (int i = 0; i < 3; i++)
            d += (x[0][p][i] - x[1][p][i]) * (x[0][p][i] - x[1][p][i]);
        most = d > most ? d : most;
    }
    return sqrt(most);
}

/* §1: a cloth falls asleep after n ≥ 30 steps in which it was never farther
 * than n/1000 of the thickness from its anchor. One that stays awake comes to
 * rest where it is, so that in m steps more it is within m/1000 of the
 * thickness, beside the n/1000 by which it may tremble there: at most (2·n + m)
 * /1000 from the one that sleeps, n here less than the steps so far. */
static const char *check_drift(int how, int *asleep)
{
    static struct ensemble e;
    drape_world *world[2] = {NULL, NULL};
    drape_step_report r[2] = {{0}};
    ensemble_make(&e, how);
    double thousandth = 1e-3 * e.d.cloth.material.thickness * 1.25;
    const char *failed = make_both(&e, world);
    int slept = 0;
    for (int k = 0; k < ENSEMBLE_STEPS && !failed; k++) {
        for (int j = 0; j < 2; j++) {
            EXPECT(ensemble_call(world[j], &e, k) == DRAPE_OK);
            EXPECT(drape_step(world[j], &r[j]) == DRAPE_OK);
        }
        slept += r[0].asleep > 1; /* the one that slides, too */
        EXPECT(apart(world) <= (slept ? 2 * k + slept : 0) * thousandth);
        ran(1);
    }
    *asleep += slept;
    drape_destroy(world[0]);
    drape_destroy(world[1]);
    return failed;
}

const char *test_sleep_beside(void)
{
    const char *failed = check_twice(true);
    failed = failed ? failed : check_twice(false);
    failed = failed ? failed : check_swayed();
    for (int how = 0; how < ENSEMBLE_HOWS - 1 && !failed; how++) {
        int asleep = 0, woke = 0, rested = 0;
        failed = check_still(how, &asleep, &woke);
        EXPECT(failed || (asleep > 5 && woke == 1));
        failed = failed ? failed : check_drift(how, &rested);
        EXPECT(failed || how > 0 || rested > 5); /* Baraff-Witkin rests soon */
    }
    return failed;
}
