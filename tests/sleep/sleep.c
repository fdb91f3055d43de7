/* SPDX-License-Identifier: Apache-2.0 */
/* Islands fall asleep while others move, and wake where something comes near.
 * spec/sleep/sleep.md */
#include "tests/world/recall.h"
#include "tests/world/scene.h"
#include "tests/world/slab.h"
#include "tests/world/twin.h"

enum { STILL, THROWN, ABOVE, HELD, LATER, SECOND, CLOTHS };
enum { SIDE = SLAB_SMALL, COUNT = SIDE * SIDE };
/* Steps, counted from 0: the last before three cloths are asleep, and before a
 * fourth is; the first in which the pin moves, the thrown cloth is near, the
 * second is, the slab is near. */
enum {
    TIRED = 29,
    TIRED_LATER = 38,
    PULLED = 40,
    THROWN_NEAR = 43,
    SECOND_NEAR = 48,
    SLAB_NEAR = 53,
    END = 64
};

/* Cloths float, far apart. One is thrown at another that is still, the slab
 * rises towards a third, and a pin pulls the fourth. The fifth is carried by
 * its pins at first, so that it falls asleep later, elsewhere than the first
 * query found it, and a second is thrown at it. */
struct apart {
    struct slab d;
    drape_cloth cloth[CLOTHS];
    drape_obstacle obstacle[2];
    drape_pin pin, carry[COUNT];
    drape_motion motion[3];
    double v[COUNT][3];
};

/* Two still slabs, one on either side of the cloth that is still: so near that
 * the tree has to tell that they are apart, in each step. */
static void make_gate(drape_obstacle *o)
{
    static double x[16][3];
    static int32_t tri[24][3];
    for (int k = 0; k < 16; k++) {
        for (int i = 0; i < 3; i++)
            x[k][i] = o->x[k % 8][i];
        x[k][0] += k < 8 ? 3.5 : 4.5;
        x[k][1] += k < 8 ? 0 : 0.4;
    }
    for (int t = 0; t < 24; t++)
        for (int i = 0; i < 3; i++)
            tri[t][i] = o->tri[t % 12][i] + (t < 12 ? 0 : 8);
    o->x = (const double(*)[3])x;
    o->tri = (const int32_t(*)[3])tri;
    o->n_vertices = 16;
    o->n_triangles = 24;
    o->motion = -1;
}

static drape_world *make_apart(struct apart *a, int integrator, int sleep)
{
    static const double rise_at[3] = {0, 44 / 64.0, 1};
    static const double rise[3][3] = {{0}, {0}, {0, 0.3, 0}};
    static const double carry_at[2] = {0, 10 / 64.0};
    static const double way[2][3] = {{0}, {1, 0, 0}};
    static const double pull_at[3] = {0, PULLED / 64.0, 2};
    static const double pull[3][3] = {{0}, {0}, {0, 0.3, 0}};
    slab_small(&a->d, integrator, 0.25);
    drape_def *def = &a->d.def;
    for (int k = 0; k < CLOTHS; k++)
        a->cloth[k] = a->d.cloth;
    a->cloth[STILL].origin[0] = 4;
    a->cloth[THROWN].origin[0] = 4.01;
    a->cloth[THROWN].origin[1] = 0.25 + 44 / 64.0;
    a->cloth[HELD].origin[0] = -4;
    for (int p = 0; p < COUNT; p++)
        a->v[p][1] = -1;
    a->cloth[THROWN].velocity = (const double(*)[3])a->v;
    a->pin = (drape_pin){0, 0, 1};
    a->cloth[HELD].pins = &a->pin;
    a->cloth[HELD].n_pins = 1;
    for (int p = 0; p < COUNT; p++)
        a->carry[p] = (drape_pin){p % SIDE, p / SIDE, 2};
    a->cloth[LATER].pins = a->carry;
    a->cloth[LATER].n_pins = COUNT;
    a->cloth[LATER].origin[0] = 8;
    a->cloth[SECOND] = a->cloth[THROWN];
    a->cloth[SECOND].origin[0] = 9.01;
    a->cloth[SECOND].origin[1] = 0.25 + 49 / 64.0;
    a->motion[2] = (drape_motion){.keys = 2, .time = carry_at, .position = way};
    a->motion[0] = (drape_motion){.keys = 3, .time = rise_at, .position = rise};
    a->motion[1] = (drape_motion){.keys = 3, .time = pull_at, .position = pull};
    def->motions = a->motion;
    def->n_motions = 3;
    a->obstacle[0] = a->obstacle[1] = a->d.obstacle;
    make_gate(&a->obstacle[1]);
    def->obstacles = a->obstacle;
    def->n_obstacles = 2;
    def->cloths = a->cloth;
    def->n_cloths = CLOTHS;
    def->gravity[1] = 0;
    def->sleep = sleep;
    return slab_world(&a->d);
}

/* §1, §4: how many sleep after step k. */
static int sleepers(int k)
{
    int asleep = k < TIRED ? 0 : 3;
    asleep += k >= TIRED_LATER;
    asleep -= (k >= PULLED) + (k >= THROWN_NEAR) + (k >= SECOND_NEAR) +
              (k >= SLAB_NEAR);
    return asleep;
}

/* The cloths rest so well that a world in which nothing sleeps has the same
 * bits. */
static const char *check_bits(int integrator)
{
    static struct apart a, b;
    drape_world *sleeps = make_apart(&a, integrator, 1);
    drape_world *wakes = make_apart(&b, integrator, 0);
    EXPECT(sleeps && wakes);
    int64_t met = 0;
    for (int k = 0; k < END; k++) {
        drape_step_report r, s;
        EXPECT(drape_step(sleeps, &r) == DRAPE_OK);
        EXPECT(drape_step(wakes, &s) == DRAPE_OK);
        EXPECT(r.asleep == sleepers(k) && s.asleep == 0);
        EXPECT(scene_hash(sleeps) == scene_hash(wakes));
        EXPECT(r.contacts == s.contacts && r.impacts == s.impacts);
        met += r.contacts + r.impacts;
        ran(1);
    }
    EXPECT(met > 0);
    drape_destroy(sleeps);
    drape_destroy(wakes);
    return NULL;
}

const char *test_sleep_apart(void)
{
    static const int some[] = {DRAPE_BW, DRAPE_CK, DRAPE_BDF2};
    const char *failed = NULL;
    for (int k = 0; k < 3 && !failed; k++)
        failed = check_bits(some[k]);
    return failed;
}

/* A checkpoint of a world in which some sleep goes on with the same bits, also
 * where the world that loads it had others asleep. */
const char *test_sleep_resumed(void)
{
    static const int some[] = {DRAPE_BW, DRAPE_BDF2};
    static struct apart a, b;
    static struct recall from, one, two;
    for (int m = 0; m < 2; m++)
        for (int at = TIRED - 4; at < END; at += 9) {
            drape_world *whole = make_apart(&a, some[m], 1);
            drape_world *again = make_apart(&b, some[m], 1);
            EXPECT(whole && again);
            for (int k = 0; k < at; k++)
                drape_step(whole, NULL);
            for (int k = 0; k < at % 4 * 11; k++)
                drape_step(again, NULL);
            EXPECT(recall_save(whole, &from));
            EXPECT(recall_load(again, &from) == DRAPE_OK);
            for (int k = at; k < END; k++) {
                drape_step_report r, s;
                EXPECT(drape_step(whole, &r) == DRAPE_OK);
                EXPECT(drape_step(again, &s) == DRAPE_OK);
                EXPECT(r.asleep == sleepers(k) && s.asleep == r.asleep);
                EXPECT(r.kinetic == s.kinetic && r.elastic == s.elastic);
                EXPECT(recall_save(whole, &one) && recall_save(again, &two));
                EXPECT(recall_same(&one, &two));
                ran(1);
            }
            drape_destroy(whole);
            drape_destroy(again);
        }
    return NULL;
}

const char *test_sleep_twins(void)
{
    static const int some[] = {DRAPE_BW, DRAPE_CK};
    for (int m = 0; m < 2; m++) {
        static struct apart a;
        struct twin twin;
        if (scene_left_out(some[m], DRAPE_GPU))
            continue;
        drape_destroy(make_apart(&a, some[m], 1));
        if (some[m] == DRAPE_CK)
            a.d.def.precond = DRAPE_JACOBI; /* emulated multigrid is slow */
        const char *failed = twin_run(&a.d.def, END, &twin);
        if (failed)
            return failed;
        EXPECT(twin.steps == END);
        ran(twin.steps);
    }
    return NULL;
}

/* Two sheets on a slab, one sheet that hangs and swings, and a second slab that
 * comes close to the upper one slowly from step LOWERED on. */
enum { LOWERED = 420, PILE = 3 };
struct pile {
    struct slab d;
    drape_cloth cloth[PILE];
    drape_obstacle slab[2];
    drape_pin pin[SIDE];
    drape_motion motion;
};

static drape_world *make_pile(struct pile *p)
{
    static const double at[4] = {0, LOWERED / 64.0, (LOWERED + 8) / 64.0,
                                 (LOWERED + 34) / 64.0};
    static const double way[4][3] = {
        {0, 0.5, 0}, {0, 0.5, 0}, {0, 0.118, 0}, {0, 0.105, 0}};
    slab_small(&p->d, DRAPE_BW, 0.103);
    drape_def *def = &p->d.def;
    for (int k = 0; k < PILE; k++) {
        p->cloth[k] = p->d.cloth;
        p->slab[k % 2] = p->d.obstacle;
    }
    p->cloth[1].origin[1] = 0.106;
    p->cloth[2].origin[0] = 1;
    for (int i = 0; i < SIDE; i++)
        p->pin[i] = (drape_pin){i, 0, -1};
    p->cloth[2].pins = p->pin;
    p->cloth[2].n_pins = SIDE;
    p->cloth[2].material.damping = 0;
    p->slab[0].motion = -1;
    p->motion = (drape_motion){.keys = 4, .time = at, .position = way};
    def->motions = &p->motion;
    def->obstacles = p->slab;
    def->n_obstacles = 2;
    def->cloths = p->cloth;
    def->n_cloths = PILE;
    return slab_world(&p->d);
}

/* §1, §3, §4: sheets that touch fall asleep and wake together, and nothing is
 * computed for them meanwhile. */
const char *test_sleep_island(void)
{
    static struct pile p;
    static double x[PILE * COUNT + 16][3], kept[PILE * COUNT + 16][3];
    drape_world *world = make_pile(&p);
    EXPECT(world);
    int slept = 0;
    int64_t awake = 0;
    for (int k = 0; k < LOWERED + 40; k++) {
        drape_step_report r;
        EXPECT(drape_step(world, &r) == DRAPE_OK);
        EXPECT(r.outcome == 0);
        drape_read(world, x, NULL);
        if (r.asleep && slept++ == 0)
            memcpy(kept, x, sizeof x);
        if (slept == 0)
            awake = r.work.boxes;
        EXPECT(r.asleep == 0 || r.asleep == 2);
        if (r.asleep)
            EXPECT(!memcmp(kept, x, 2 * COUNT * sizeof *x));
        if (slept > 1 && r.asleep)
            EXPECT(r.contacts == 0 && r.work.boxes < awake);
        ran(1);
    }
    EXPECT(slept > 100);
    drape_destroy(world);
    return NULL;
}

/* Makes two sheets of which pins carry the upper one by `way` in 4 s. */
static drape_world *make_carried(int integrator, int cloths,
                                 const double way[2][3])
{
    static const double at[2] = {0, 4};
    static drape_pin pin[COUNT];
    static drape_cloth cloth[2];
    static struct slab d;
    slab_small(&d, integrator, 0.103);
    d.cloth.material.friction = 0;
    cloth[0] = cloth[1] = d.cloth;
    for (int p = 0; p < COUNT; p++)
        pin[p] = (drape_pin){p % SIDE, p / SIDE, 0};
    cloth[1].pins = pin;
    cloth[1].n_pins = COUNT;
    cloth[1].origin[1] += 0.003;
    d.motion = (drape_motion){.keys = 2, .time = at, .position = way};
    d.obstacle.motion = -1;
    d.def.cloths = cloth + (2 - cloths);
    d.def.n_cloths = cloths;
    return slab_world(&d);
}

/* §1, §2: a sheet that its pins carry is not tired, however slowly; nor does
 * one sleep that it touches, nor any other where contacts are not kept. */
const char *test_sleep_carried(void)
{
    static const double slow[2][3] = {{0}, {0, 0, 1e-4}};
    static const double fast[2][3] = {{0}, {5e-3, 0, 0}};
    for (int how = 0; how < 3; how++) {
        drape_world *world = make_carried(how == 2 ? DRAPE_VERLET : DRAPE_BW,
                                          how ? 2 : 1, how ? fast : slow);
        EXPECT(world);
        for (int k = 0; k < 240; k++) {
            drape_step_report r;
            EXPECT(drape_step(world, &r) == DRAPE_OK && r.asleep == 0);
            EXPECT(how != 1 || r.contacts > 0);
            ran(1);
        }
        drape_destroy(world);
    }
    return NULL;
}
