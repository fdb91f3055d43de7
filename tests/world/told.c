/* SPDX-License-Identifier: Apache-2.0 */
/* What the host of a step tells its backend and asks of it, heard by a backend
 * that listens and lets the reference do the work. spec/world/step.md §12 */
#include "ref/cloth/implicit.h"
#include "ref/cloth/motion.h"
#include "ref/world/state.h"
#include "ref/world/step.h"
#include "tests/world/slab.h"

enum { SIDE = SLAB_SMALL, COUNT = SIDE * SIDE };

/* What was heard of the step under way. */
static struct {
    vec x[COUNT], v[COUNT]; /* the first cloth as its motion left it */
    int motions, loops, pasts, energies; /* calls */
    bool right; /* what was told is what the pages say */
} heard;

static void note_motion(const struct sheet *s)
{
    size_t bytes = (size_t)s->cloth.count * sizeof *heard.x;
    if (s->first == 0) {
        memcpy(heard.x, s->dynamics.x1, bytes);
        memcpy(heard.v, s->dynamics.v1, bytes);
    }
}

static int hear_motion(struct gpu *on, struct sheet *s)
{
    int status = backend_ref.motion(on, s);
    note_motion(s);
    heard.motions++;
    return status;
}

/* The loop of contacts ends a motion in its own way. */
static int hear_part(struct gpu *on, struct sheet *s, int part)
{
    int status = backend_ref.motion_part(on, s, part);
    if (part == MOTION_END) {
        note_motion(s);
        heard.loops++;
    }
    return status;
}

static int hear_history(struct gpu *on, struct history *h)
{
    size_t bytes = (size_t)h->count * sizeof *h->x;
    heard.pasts++;
    heard.right &= !memcmp(h->x1, heard.x, bytes);
    heard.right &= !memcmp(h->v1, heard.v, bytes);
    return backend_ref.history(on, h);
}

static void hear_energy(struct gpu *on, struct sheet *s, const vec *x,
                        const vec *v, double value[3])
{
    heard.energies++;
    backend_ref.motion_energy(on, s, x, v, value);
}

/* Makes a world that a listening backend steps. */
static struct world *make_heard(const drape_def *def, struct arena *arena)
{
    static struct backend ear;
    struct world *w = slab_inner(def, arena);
    ear = backend_ref;
    ear.motion = hear_motion;
    ear.motion_part = hear_part;
    ear.history = hear_history;
    ear.motion_energy = hear_energy;
    if (w)
        w->run = &ear;
    return w;
}

/* Makes a step. Returns its status. */
static int step_heard(struct world *w, drape_step_report *r)
{
    heard.motions = heard.loops = heard.pasts = heard.energies = 0;
    heard.right = true;
    return step_advance(w, r);
}

/* implicit.md §4: history reads x1 and v1 as the motion made them, or as the
 * loop of contacts ended it, of the last slice, whether rounds of impulses have
 * changed one of them, both or none. */
const char *test_told_past(void)
{
    static const drape_pin pin = {0, 0, -1};
    for (int k = 0; k < 4; k++) {
        struct slab d;
        struct arena arena;
        drape_step_report r;
        int x = 0, v = 0, loops = 0;
        bool solves = k == 3;
        slab_small(&d, DRAPE_CK, 0.1035);
        d.obstacle.motion = -1;
        d.def.response = solves ? DRAPE_SOLVE : DRAPE_IMPULSES;
        if (k == 1) { /* nothing can collide; a pin: momentum may change */
            d.def.n_obstacles = d.def.self_collision = 0;
            d.cloth.pins = &pin;
            d.cloth.n_pins = 1;
        }
        if (k == 2) /* steps of several slices */
            d.def.gravity[1] = -600;
        struct world *w = make_heard(&d.def, &arena);
        EXPECT(w && w->nc == COUNT && w->plan.collides == (k != 1));
        for (int step = 0; step < 8; step++) {
            EXPECT(step_heard(w, &r) == DRAPE_OK && heard.right);
            EXPECT(heard.pasts == r.slices && (r.slices == 1 || k == 2));
            x += memcmp(heard.x, w->x0, sizeof heard.x) != 0;
            v += memcmp(heard.v, w->v0, sizeof heard.v) != 0;
            loops += heard.loops;
            ran(1);
        }
        bool rounds = k == 0 || k == 2;
        EXPECT((x > 0) == rounds && (v > 0) == rounds);
        EXPECT((loops > 0) == solves);
        arena_free(&arena);
    }
    return NULL;
}

/* step.md §7.3: the energies that a step reports are those of the state that it
 * leaves. They are computed anew only where contact may have changed the state
 * and somebody reads the report. */
static const char *check_energy(const struct slab *d, int *met)
{
    struct arena arena[2];
    struct world *w[2];
    drape_step_report r;
    for (int k = 0; k < 2; k++)
        w[k] = make_heard(&d->def, &arena[k]);
    EXPECT(w[0] && w[1]);
    for (int step = 0; step < 5; step++) {
        double e[3];
        EXPECT(step_heard(w[0], &r) == DRAPE_OK && r.work.tries == 1);
        EXPECT(heard.energies == w[0]->met);
        backend_ref.motion_energy(w[0]->on, w[0]->sheet, w[0]->x0, w[0]->v0, e);
        EXPECT(r.kinetic == e[0] && r.elastic == e[1] && r.potential == e[2]);
        EXPECT(step_heard(w[1], NULL) == DRAPE_OK);
        EXPECT(heard.motions + heard.loops > 0);
        EXPECT(heard.energies == 0);
        EXPECT(w[0]->met == w[1]->met);
        met[w[0]->met]++;
        ran(1);
    }
    for (int k = 0; k < 2; k++)
        arena_free(&arena[k]);
    return NULL;
}

const char *test_told_energy(void)
{
    static const int some[] = {DRAPE_VERLET, DRAPE_BW, DRAPE_CK};
    static const double rest[2][3] = {{0}};
    const char *failed = NULL;
    int met[2] = {0, 0}; /* steps away from everything, steps in contact */
    for (int k = 0; k < 4 * 3 && !failed; k++) {
        struct slab d;
        bool still = k / 3 != 1, windless = k / 3 != 2;
        slab_small(&d, some[k % 3], k % 3 ? 0.112 : 0.10502);
        d.obstacle.motion = still && k / 3 != 3 ? -1 : 0;
        if (still)
            d.motion.position = rest;
        d.def.wind = (drape_wind){
            .velocity = {0, -3, 0}, .density = windless ? 0 : 1.2, .drag = 1};
        failed = check_energy(&d, met);
    }
    EXPECT(failed || (met[0] > 0 && met[1] > 0));
    return failed;
}

/* dynamics.md §3: each cloth has a reference and a surplus of its own, which a
 * cloth far away does not change. */
static const char *check_watch(int integrator)
{
    static double v[2][COUNT][3];
    drape_cloth cloth[2];
    struct slab d;
    struct arena arena[3];
    struct world *w[3]; /* of one cloth, of the other, of both */
    slab_small(&d, integrator, 1);
    d.def.n_obstacles = d.def.self_collision = 0;
    for (int k = 0; k < 2; k++) {
        for (int p = 0; p < 3 * COUNT; p++)
            v[k][p / 3][p % 3] = ((p * p + 7 * k) % 11 - 5) / (k + 1.0);
        cloth[k] = d.cloth;
        cloth[k].velocity = (const double(*)[3])v[k];
    }
    for (int k = 0; k < 3; k++) {
        d.def.cloths = cloth + k % 2;
        d.def.n_cloths = k < 2 ? 1 : 2;
        w[k] = slab_inner(&d.def, &arena[k]);
        EXPECT(w[k]);
    }
    for (int step = 0; step < 4; step++) {
        for (int k = 0; k < 3; k++)
            EXPECT(step_advance(w[k], NULL) == DRAPE_OK);
        for (int j = 0; j < 2; j++) {
            EXPECT(w[2]->watch[0][j] == w[0]->watch[0][j]);
            EXPECT(w[2]->watch[1][j] == w[1]->watch[0][j]);
            EXPECT(j > step || w[0]->watch[0][j] != w[1]->watch[0][j]);
        }
        for (int k = 0; k < 2 && step == 0; k++) /* J, as if gained before */
            w[2]->watch[k][1] = w[k]->watch[0][1] = k + 1;
        ran(1);
    }
    for (int k = 0; k < 3; k++)
        arena_free(&arena[k]);
    return NULL;
}

const char *test_told_watch(void)
{
    static const int some[] = {DRAPE_VERLET, DRAPE_BW, DRAPE_CK};
    const char *failed = NULL;
    for (int k = 0; k < 3 && !failed; k++)
        failed = check_watch(some[k]);
    return failed;
}
