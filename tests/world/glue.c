/* SPDX-License-Identifier: Apache-2.0 */
/* Properties of whole steps: pins, sleep, friction of a pair, the check of the
 * start, the length of slices, warm start. spec/world/step.md */
#include <stdio.h>
#include <stdlib.h>

#include "ref/cloth/implicit.h"
#include "ref/world/state.h"
#include "ref/world/step.h"
#include "tests/solve/system.h"
#include "tests/world/recall.h"
#include "tests/world/scene.h"
#include "tests/world/slab.h"

enum { SIDE = 12, COUNT = SIDE * SIDE };

/* Makes a small sheet at height y above the slab, whose top is at y = 0.1. Its
 * cells are 1/64 m, so that rounding exerts no force. */
static void make_small(struct slab *d, int integrator, double y)
{
    slab_make(d, integrator);
    d->cloth.m = d->cloth.n = SIDE;
    d->cloth.width = d->cloth.height = (SIDE - 1) / 64.0;
    d->cloth.origin[0] = d->cloth.origin[2] = -0.0625;
    d->cloth.origin[1] = y;
    d->def.dt = integrator < DRAPE_BW ? 0x1p-10 : 0x1p-6;
}

/* kinematics.md §1: led vertices are where they are told to be. The first sheet
 * has a hole, a fixed pin and a moving pin; a second sheet is thrown at it. */
static drape_world *make_pinned(struct slab *d, int integrator)
{
    static const double times[2] = {0, 1};
    static const double way[2][3] = {{0, 0, 0}, {0.25, 0.5, 0}};
    static double v[COUNT][3];
    static uint8_t hole[COUNT];
    static const drape_pin pin[3] = {{3, 4, -1}, {8, 7, 0}, {5, 5, -1}};
    static drape_cloth cloth[2];
    make_small(d, integrator, 0.25);
    d->motion = (drape_motion){2, times, way, NULL, {0, 0, 0}};
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
    int led = 8 + 7 * SIDE;
    drape_read(world, x, v);
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < 3; i++)
            EXPECT(x[held[k]][i] == x0[held[k]][i] && v[held[k]][i] == 0);
    for (int i = 0; i < 3; i++) {
        double want = x0[led][i] + t * way[i];
        EXPECT(fabs(x[led][i] - want) <= 2 * (double)REAL_UNIT);
        EXPECT(fabs(v[led][i] - way[i]) <= 1e-3);
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

enum waking { BY_OBSTACLE, BY_PIN, BY_FRAMES, BY_WIND, BY_CALL, WAKINGS };
enum { RESTS = 34, TO = 38 };

/* Makes a sheet at rest without gravity; after RESTS steps a motion or a call
 * wakes the scene in the way `how` says. */
static drape_world *make_resting(enum waking how, int integrator, int sleep)
{
    static double time[3], frame[3 * 8][3];
    static const double way[3][3] = {{0}, {0}, {0.125, 0.25, 0}};
    static const drape_pin pin = {2, 3, 0};
    struct slab d;
    make_small(&d, integrator, 0.5);
    time[1] = RESTS * d.def.dt;
    time[2] = 2 * time[1];
    d.motion = (drape_motion){3, time, way, NULL, {0, 0, 0}};
    d.def.gravity[1] = 0;
    d.def.sleep = sleep;
    d.obstacle.motion = how == BY_OBSTACLE ? 0 : -1;
    if (how == BY_PIN) {
        d.cloth.pins = &pin;
        d.cloth.n_pins = 1;
    }
    if (how == BY_WIND)
        d.def.wind = (drape_wind){{0, 0, 0}, 1, 1, 0.5};
    for (int k = 0; k < 3 * 8; k++)
        for (int i = 0; i < 3; i++)
            frame[k][i] = d.obstacle.x[k % 8][i] + (k < 16 ? 0 : 0.25);
    if (how == BY_FRAMES) {
        d.obstacle.frames = 3;
        d.obstacle.frame_dt = time[1];
        d.obstacle.frame = (const double(*)[3])frame;
    }
    return slab_world(&d);
}

static int advance(drape_world *world, enum waking how, int step)
{
    const drape_wind gale = {{0, 3, 0}, 1, 1, 0.5};
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

/* proximity.md: a pair has the larger friction of its two surfaces. Runs a
 * sheet on a slope; returns the hash after some steps, 0 if a step fails. */
static uint64_t slide(int integrator, double cloth, double slab)
{
    struct slab d;
    make_small(&d, integrator, 0.1039);
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

/* A start that intersects */

enum crossing { ITSELF, ANOTHER, SLAB, CROSSINGS };

/* Makes a start that intersects: a sheet through itself; a flat sheet through a
 * crumpled one, in more pairs than the audit's first capacity; or a sheet
 * through the slab. */
static void make_crossing(struct slab *d, enum crossing how)
{
    enum { M = 30 };
    static double x[M * M][3];
    static drape_cloth cloth[2];
    slab_make(d, DRAPE_BW);
    d->cloth.m = d->cloth.n = M;
    for (int k = 0; k < M * M; k++) {
        double i = k % M, away = i > M / 2 ? i - M / 2 : 0;
        x[k][0] = how == ITSELF ? 0.01 * (i - 2 * away) : 0.01 * i;
        x[k][1] = how == ITSELF ? 0.3 + (i < M / 2 ? 0.01 * (i - M / 4) : 0)
                                : 0.3 + 0.004 * noise_of((uint64_t)k);
        x[k][2] = 0.01 * (k / M);
    }
    cloth[0] = cloth[1] = d->cloth;
    cloth[0].x = (const double(*)[3])x;
    cloth[1].origin[0] = cloth[1].origin[2] = 0;
    cloth[1].width = cloth[1].height = 0.01 * (M - 1);
    cloth[1].origin[1] = how == ANOTHER ? 0.3 : 0.7;
    if (how == SLAB) {
        cloth[0] = cloth[1];
        cloth[0].origin[1] = 0.05;
    }
    d->def.cloths = cloth;
    d->def.n_cloths = 2;
}

/* Such a start is refused, unless allow_intersecting is set, or only cloths
 * cross and self_collision is off. */
static const char *check_start(enum crossing how)
{
    struct slab d;
    drape_world *world;
    drape_error error;
    long long told = -1;
    make_crossing(&d, how);
    d.def.allow_intersecting = 1;
    EXPECT(drape_create(&d.def, &world, &error) == DRAPE_OK);
    int64_t found = scene_audit(world, 2);
    drape_destroy(world);
    EXPECT(found > (how == ANOTHER ? 1024 : 0));
    d.def.allow_intersecting = 0;
    EXPECT(drape_create(&d.def, &world, &error) == DRAPE_ESTART && !world);
    const char *more = strstr(error.text, "(first of ");
    EXPECT((more ? sscanf(more, "(first of %lld pairs)", &told) : found == 1) ==
           1);
    EXPECT(!more || told == found);
    d.def.self_collision = 0;
    int status = drape_create(&d.def, &world, &error);
    EXPECT(status == (how == SLAB ? DRAPE_ESTART : DRAPE_OK));
    drape_destroy(world);
    ran(1);
    return NULL;
}

const char *test_world_start(void)
{
    const char *failed = NULL;
    for (int how = 0; how < CROSSINGS && !failed; how++)
        failed = check_start((enum crossing)how);
    return failed;
}

/* step.md §3: the early test whether anything is near changes no bit */

static struct world *make_inner(const drape_def *def, struct arena *arena)
{
    struct world *w;
    drape_error error;
    arena_init(arena, &def->allocator);
    return world_make(def, arena, &w, &error) == DRAPE_OK ? w : NULL;
}

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
        w[k] = make_inner(&d->def, &arena[k]);
    EXPECT(w[0] && w[1]);
    size_t bytes = (size_t)w[0]->nv * sizeof(vec);
    for (int step = 0; step < 3; step++) {
        if (w[1]->near == NEAR_NONE)
            w[1]->near = NEAR_PAIRS;
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
        make_small(&d, k % 3 == 0 ? DRAPE_VERLET : DRAPE_BW, 0.2);
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
        double most = k ? 8 : 4; /* cells, limit of relative displacement */
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
        make_small(&d, DRAPE_BW, 0.103);
        for (int k = 0; k < 3 * COUNT; k++)
            v[k / 3][k % 3] = 5 * noise_of((uint64_t)k);
        d.cloth.velocity = (const double(*)[3])v;
        d.cloth.material.stretch = 0.1; /* so soft that the sheet crumples */
        d.cloth.material.shear = 0.02;
        d.cloth.material.bend = 0;
        d.def.max_rounds = rounds;
        d.def.max_slices = 1;
        struct world *w = make_inner(&d.def, &arena);
        EXPECT(w);
        for (int step = 0; step < 12; step++) {
            EXPECT(step_advance(w, &r) == DRAPE_OK);
            bool bad = slice_failed(r.outcome);
            EXPECT(w->pressed == (!bad && r.contacts > 0));
            EXPECT(w->pressed || !presses(w));
            EXPECT((w->near == NEAR_CONTACTS) == (r.contacts > 0));
            failed += bad && r.contacts > 0;
            held += w->pressed && presses(w);
            ran(1);
        }
        arena_free(&arena);
    }
    EXPECT(failed > 0 && held > 0);
    return NULL;
}

/* A step without a report has the same bits. */
const char *test_world_unread(void)
{
    static struct recall state[2];
    for (int integrator = DRAPE_VERLET; integrator <= DRAPE_CK; integrator++) {
        struct slab d;
        drape_step_report r;
        make_small(&d, integrator, 0.105);
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

/* implicit.md §4: Choi–Ko remembers the motion without contact. */
const char *test_world_past(void)
{
    static vec x0[COUNT], v0[COUNT], xp[COUNT], vp[COUNT];
    struct slab d;
    struct arena arena;
    drape_step_report r;
    int parted = 0;
    make_small(&d, DRAPE_CK, 0.1035);
    d.obstacle.motion = -1;
    struct world *w = make_inner(&d.def, &arena);
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
