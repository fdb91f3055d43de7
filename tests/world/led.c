/* SPDX-License-Identifier: Apache-2.0 */
/* Prescribed motion in whole steps: prescribed vertices are where they are
 * prescribed to be, and a sleeping scene wakes when something moves.
 * spec/world/step.md §1, §6 */
#include "ref/broad/box.h"
#include "tests/world/scene.h"
#include "tests/world/slab.h"

enum { SIDE = SLAB_SMALL, COUNT = SIDE * SIDE };

/* kinematics.md §1: prescribed vertices are where they are prescribed to be.
 * The first sheet has a hole, a fixed pin and a moving pin; a second sheet is
 * thrown at it. */
static drape_world *make_pinned(struct slab *d, int integrator)
{
    static const double times[2] = {0, 1};
    static const double way[2][3] = {{0, 0, 0}, {0.25, 0.5, 0}};
    static double v[COUNT][3];
    static uint8_t hole[COUNT];
    static const drape_pin pin[3] = {{3, 4, -1}, {8, 7, 0}, {5, 5, -1}};
    static drape_cloth cloth[2];
    slab_small(d, integrator, 0.25);
    d->motion = (drape_motion){.keys = 2, .time = times, .position = way};
    cloth[0] = cloth[1] = d->cloth;
    hole[0] = 1;
    cloth[0].pins = pin;
    cloth[0].n_pins = 3;
    cloth[0].hole = hole;
    for (int p = 0; p < COUNT; p++)
        v[p][1] = -1;
    cloth[1].velocity = cloth[0].velocity = (const double(*)[3])v;
    cloth[1].origin[1] = 0.255;
    cloth[1].origin[0] += 0.003;
    d->def.cloths = cloth;
    d->def.n_cloths = 2;
    d->def.n_obstacles = 0;
    return slab_world(d);
}

/* A fixed pin keeps its bits; a moving pin is at x(0) + p(t), rounded once. */
static const char *check_pins(const drape_world *world, const double (*x0)[3],
                              double t)
{
    static const double way[3] = {0.25, 0.5, 0};
    static double x[2 * COUNT][3], v[2 * COUNT][3];
    static const int held[3] = {3 + 4 * SIDE, 5 + 5 * SIDE, 0};
    int prescribed = 8 + 7 * SIDE;
    drape_read(world, x, v);
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < 3; i++)
            EXPECT(x[held[k]][i] == x0[held[k]][i] && v[held[k]][i] == 0);
    for (int i = 0; i < 3; i++) {
        double want = x0[prescribed][i] + t * way[i];
        EXPECT(fabs(x[prescribed][i] - want) <= 2 * (double)REAL_UNIT);
        EXPECT(fabs(v[prescribed][i] - way[i]) <= 1e-3);
    }
    return NULL;
}

const char *test_world_pins(void)
{
    static const int some[] = {DRAPE_VERLET, DRAPE_BW, DRAPE_CK};
    for (int k = 0; k < 3; k++) {
        static double x0[2 * COUNT][3];
        struct slab d;
        drape_step_report r;
        int64_t contacts = 0;
        drape_world *world = make_pinned(&d, some[k]);
        EXPECT(world);
        drape_read(world, x0, NULL);
        for (int step = 0; step < 12; step++) {
            EXPECT(drape_step(world, &r) == DRAPE_OK);
            EXPECT(!(r.outcome & (DRAPE_DIVERGED | DRAPE_TRAPPED)));
            contacts += r.contacts + r.impacts;
            const char *failed =
                check_pins(world, (const double(*)[3])x0, r.time);
            if (failed)
                return failed;
            ran(1);
        }
        EXPECT(contacts > 0); /* the sheets did meet */
        drape_destroy(world);
    }
    return NULL;
}

/* step.md §6: sleep changes no bit, and ends when something moves */

enum waking {
    BY_OBSTACLE,
    BY_PIN,
    BY_FRAMES,
    BY_WIND,
    BY_CALL,
    BY_TIMES,
    WAKINGS
};
enum { RESTS = 34, TO = 38 };

/* Makes a sheet at rest without gravity; after RESTS steps a motion or a call
 * wakes the scene in the way `how` says. */
static drape_world *make_resting(enum waking how, int integrator, int sleep)
{
    static double time[3], frame[3 * 8][3];
    static const double way[3][3] = {{0}, {0}, {0.125, 0.25, 0}};
    static const drape_pin pin = {2, 3, 0};
    struct slab d;
    slab_small(&d, integrator, 0.5);
    time[1] = RESTS * d.def.dt;
    time[2] = 2 * time[1];
    d.motion = (drape_motion){.keys = 3, .time = time, .position = way};
    d.def.gravity[1] = 0;
    d.def.sleep = sleep;
    d.obstacle.motion = how == BY_OBSTACLE ? 0 : -1;
    if (how == BY_PIN) {
        d.cloth.pins = &pin;
        d.cloth.n_pins = 1;
    }
    if (how == BY_WIND)
        d.def.wind = (drape_wind){
            .velocity = {0, 0, 0}, .density = 1, .drag = 1, .lift = 0.5};
    for (int k = 0; k < 3 * 8; k++)
        for (int i = 0; i < 3; i++)
            frame[k][i] = d.obstacle.x[k % 8][i] + (k < 16 ? 0 : 0.25);
    if (how == BY_FRAMES) {
        d.obstacle.frames = 3;
        d.obstacle.frame_dt = time[1];
        d.obstacle.frame = (const double(*)[3])frame;
    }
    if (how == BY_TIMES) { /* the first frame holds until its time */
        d.obstacle.frames = 2;
        d.obstacle.frame_time = time + 1;
        d.obstacle.frame = (const double(*)[3])frame[8];
    }
    return slab_world(&d);
}

static int advance(drape_world *world, enum waking how, int step)
{
    const drape_wind gale = {
        .velocity = {0, 3, 0}, .density = 1, .drag = 1, .lift = 0.5};
    drape_step_report r;
    if (how == BY_WIND && step == RESTS)
        drape_set_wind(world, &gale);
    if (how == BY_CALL && step == RESTS)
        drape_wake(world);
    return drape_step(world, &r) == DRAPE_OK ? r.outcome : -1;
}

/* Runs a world that may sleep beside one that may not: both have the same bits.
 */
static const char *check_sleep(enum waking how, int integrator)
{
    drape_world *a = make_resting(how, integrator, 1);
    drape_world *b = make_resting(how, integrator, 0);
    EXPECT(a && b);
    uint64_t start = scene_hash(a);
    for (int step = 0; step < TO; step++) {
        bool asleep = step >= 30 && step < RESTS;
        EXPECT(advance(a, how, step) == (asleep ? DRAPE_ASLEEP : 0));
        EXPECT(advance(b, how, step) == 0);
        uint64_t hash = scene_hash(a);
        EXPECT(hash == scene_hash(b));
        EXPECT((hash == start) == (step < RESTS || how == BY_CALL));
        ran(1);
    }
    drape_destroy(a);
    drape_destroy(b);
    return NULL;
}

const char *test_world_sleeps(void)
{
    static const int some[] = {DRAPE_VERLET, DRAPE_BW, DRAPE_CK};
    const char *failed = NULL;
    for (int how = 0; how < WAKINGS && !failed; how++)
        for (int k = how % 2; k < 3 && !failed; k += 2 - how % 2)
            failed = check_sleep((enum waking)how, some[k]);
    return failed;
}
