/* SPDX-License-Identifier: Apache-2.0 */
/* What a world says of itself between two steps: its clock, the materials of
 * its cloths and its wind are those of the last step's report and of the calls
 * that set them, also after a checkpoint or a log, on both backends.
 * spec/drape.h */
#include "ref/base/hash.h"
#include "tests/api/guest.h"
#include "tests/control/troupe.h"

/* Whether the clock is at this step and time, whichever of both is asked for.
 */
static bool at(const drape_world *world, int64_t step, double time)
{
    int64_t a = -1, b = -1;
    double s = -1, t = -1;
    ran(1);
    return drape_clock(world, &a, &s) == DRAPE_OK &&
           drape_clock(world, &b, NULL) == DRAPE_OK &&
           drape_clock(world, NULL, &t) == DRAPE_OK &&
           drape_clock(world, NULL, NULL) == DRAPE_OK && a == step &&
           b == step && s == time && t == time;
}

/* Makes a step; the clock is that of its report. Returns its outcome, or -1. */
static int tick(drape_world *world)
{
    drape_step_report r;
    if (drape_step(world, &r) != DRAPE_OK || !at(world, r.step, r.time))
        return -1;
    return r.outcome;
}

/* A step that fails leaves the clock where it is. test_world_cut has one that
 * diverges. */
static const char *stand_still(int backend)
{
    static const drape_pin pin = {0, 0, -1};
    struct guest s;
    drape_world *world;
    guest_make(&s, backend);
    s.cloth.pins = &pin;
    s.cloth.n_pins = s.def.max_slices = 1;
    EXPECT(drape_create(&s.def, &world, NULL) == DRAPE_OK);
    s.host.most = 0; /* it has yet to take what contact needs */
    s.device.most = 0;
    EXPECT(drape_step(world, NULL) == DRAPE_ENOMEM && at(world, 0, 0));
    s.host.most = s.device.most = INT64_MAX;
    EXPECT(tick(world) == 0 && at(world, 1, s.def.dt));
    drape_destroy(world);
    return NULL;
}

/* The clock goes on from a checkpoint, back to an earlier one, by a log, and
 * while bodies come and go. */
static const char *run_clock(int backend)
{
    static struct recall saved, log;
    struct troupe t, other;
    troupe_make(&t, DRAPE_BW, backend);
    troupe_make(&other, DRAPE_BW, !backend);
    drape_world *a = troupe_world(&t), *b = troupe_world(&other);
    EXPECT(a && b && at(a, 0, 0));
    for (int k = 1; k <= 3; k++)
        EXPECT(tick(a) >= 0 && at(a, k, k * t.def.dt));
    EXPECT(recall_save(a, &saved) && recall_load(b, &saved) == DRAPE_OK);
    EXPECT(at(b, 3, 3 * t.def.dt));
    log.size = log.at = 0;
    EXPECT(drape_record(a, recall_write, &log) == DRAPE_OK);
    EXPECT(guest_go(a, 2) == DRAPE_OK && at(a, 5, 5 * t.def.dt));
    EXPECT(drape_add_obstacle(a, &t.obstacle[1], NULL) == 2);
    EXPECT(drape_remove(a, 0) == DRAPE_OK && at(a, 5, 5 * t.def.dt));
    EXPECT(drape_record(a, NULL, NULL) == DRAPE_OK);
    drape_destroy(a);
    a = troupe_world(&t);
    EXPECT(a && drape_replay(a, recall_read, &log, NULL) == 1);
    EXPECT(at(a, 4, 4 * t.def.dt));
    EXPECT(drape_replay(a, recall_read, &log, NULL) == 1);
    EXPECT(drape_replay(a, recall_read, &log, NULL) == 0);
    EXPECT(at(a, 5, 5 * t.def.dt));
    EXPECT(guest_go(b, 4) == DRAPE_OK && recall_load(b, &saved) == DRAPE_OK);
    EXPECT(at(b, 3, 3 * t.def.dt));
    saved.data[0] ^= 1;
    EXPECT(recall_load(b, &saved) == DRAPE_EMATCH && at(b, 3, 3 * t.def.dt));
    drape_destroy(a);
    drape_destroy(b);
    return NULL;
}

/* Writes a step and a time into a checkpoint, at their places in the header of
 * ref/world/checkpoint.c, and makes its hash right. All of its streams are
 * whole words. */
static void forge(struct recall *r, int64_t step, double time)
{
    enum { CHECK = 24, STEP = 32, TIME = 56 };
    uint64_t check = 0;
    memcpy(r->data + STEP, &step, sizeof step);
    memcpy(r->data + TIME, &time, sizeof time);
    memcpy(r->data + CHECK, &check, sizeof check);
    check = hash_mix(HASH_SEED, r->data, r->size);
    memcpy(r->data + CHECK, &check, sizeof check);
}

/* A checkpoint whose time is not that of its step, or whose step no world can
 * have done, is refused, and the clock stays. */
static const char *refuse_clock(int backend)
{
    static struct recall r;
    static const int64_t wrong[] = {-1, ((int64_t)1 << 53) + 1, INT64_MAX,
                                    INT64_MIN};
    const int64_t most = (int64_t)1 << 53;
    struct troupe t;
    troupe_make(&t, DRAPE_BW, backend);
    drape_world *a = troupe_world(&t);
    double dt = t.def.dt;
    EXPECT(a && tick(a) >= 0 && recall_save(a, &r));
    const double times[] = {(double)NAN, (double)INFINITY, 0, -dt, 2 * dt};
    for (int k = 0; k < 5; k++) {
        forge(&r, 1, times[k]);
        EXPECT(recall_load(a, &r) == DRAPE_EDATA && at(a, 1, dt));
    }
    for (int k = 0; k < 4; k++) {
        forge(&r, wrong[k], (double)wrong[k] * dt);
        EXPECT(recall_load(a, &r) == DRAPE_EDATA && at(a, 1, dt));
    }
    const int64_t good[] = {0, 7, most};
    for (int k = 0; k < 3; k++) {
        forge(&r, good[k], (double)good[k] * dt);
        EXPECT(recall_load(a, &r) == DRAPE_OK);
        EXPECT(at(a, good[k], (double)good[k] * dt));
    }
    drape_destroy(a);
    return NULL;
}

const char *test_api_clock(void)
{
    const char *what = NULL;
    for (int backend = DRAPE_REF; backend <= DRAPE_GPU && !what; backend++) {
        what = stand_still(backend);
        what = what ? what : run_clock(backend);
        what = what ? what : refuse_clock(backend);
    }
    return what;
}

/* Whether cloth k has this material, and a world this wind: every bit, and no
 * more is written than the struct. */
static bool made_of(const drape_world *world, int k, const drape_material *m)
{
    drape_material now[2];
    memset(now, 0x5a, sizeof now);
    drape_material rest = now[1];
    ran(1);
    return drape_read_material(world, k, now) == DRAPE_OK &&
           !memcmp(now, m, sizeof *m) && !memcmp(now + 1, &rest, sizeof rest);
}

static bool blown_by(const drape_world *world, const drape_wind *wind)
{
    drape_wind now[2];
    memset(now, 0x5a, sizeof now);
    drape_wind rest = now[1];
    ran(1);
    return drape_read_wind(world, now) == DRAPE_OK &&
           !memcmp(now, wind, sizeof *wind) &&
           !memcmp(now + 1, &rest, sizeof rest);
}

static bool pulled_by(const drape_world *world, const double gravity[3])
{
    double now[4] = {0, 0, 0, -1};
    ran(1);
    return drape_read_gravity(world, now) == DRAPE_OK &&
           !memcmp(now, gravity, 3 * sizeof *now) && now[3] == -1;
}

/* A scene on both backends: [0] is that of the definition, [1] what is set. The
 * numbers are not those of binary32. */
struct settings {
    struct troupe t;
    drape_material of[2][2]; /* [cloth][which] */
    drape_wind wind[2];
    double gravity[2][3]; /* set with the wind */
    drape_world *world[2];
};

static const char *define(struct settings *s, int backend)
{
    memset(s, 0, sizeof *s);
    troupe_make(&s->t, DRAPE_BW, backend);
    for (int k = 0; k < 2; k++) {
        drape_material *m = &s->t.cloth[k].material;
        m->density = 0.21 + 0.1 * k;
        m->table[DRAPE_WEFT][0][0] = 0.01;
        m->table[DRAPE_WEFT][0][1] = 8.1;
        s->of[k][0] = s->of[k][1] = *m;
        s->of[k][1].bend = 3e-5;
        s->of[k][1].limit[2] = 0.3;
        s->of[k][1].table[DRAPE_WARP][0][0] = 0.02;
        s->of[k][1].table[DRAPE_WARP][0][1] = 7.3;
    }
    s->wind[0] = s->wind[1] = s->t.def.wind;
    s->wind[1].velocity[2] = 0.1;
    s->wind[1].drag = 0.7;
    memcpy(s->gravity[0], s->t.def.gravity, sizeof s->gravity[0]);
    s->gravity[1][2] = -1.6;
    for (int k = 0; k < 2; k++) {
        s->t.def.backend = k ? !backend : backend;
        s->world[k] = troupe_world(&s->t);
        EXPECT(s->world[k]);
    }
    return NULL;
}

/* Which material each cloth has, and which wind and gravity there are. */
static bool is(const struct settings *s, int k, int first, int second, int wind)
{
    const drape_world *w = s->world[k];
    return made_of(w, 0, &s->of[0][first]) &&
           made_of(w, 1, &s->of[1][second]) && blown_by(w, &s->wind[wind]) &&
           pulled_by(w, s->gravity[wind]);
}

static const char *set_and_load(struct settings *s)
{
    static struct recall plain, changed, log;
    drape_world *a = s->world[0], *b = s->world[1];
    EXPECT(is(s, 0, 0, 0, 0) && recall_save(a, &plain));
    log.size = log.at = 0;
    EXPECT(drape_record(a, recall_write, &log) == DRAPE_OK);
    EXPECT(drape_set_material(a, 1, &s->of[1][1]) == DRAPE_OK);
    EXPECT(is(s, 0, 0, 1, 0));
    EXPECT(drape_set_wind(a, &s->wind[1]) == DRAPE_OK);
    EXPECT(drape_set_gravity(a, s->gravity[1]) == DRAPE_OK);
    EXPECT(is(s, 0, 0, 1, 1));
    drape_material bad = s->of[0][1];
    drape_wind storm = s->wind[0];
    bad.shear = bad.stretch;
    storm.drag = -1;
    EXPECT(drape_set_material(a, 0, &bad) == DRAPE_EARG);
    EXPECT(drape_set_wind(a, &storm) == DRAPE_EARG && is(s, 0, 0, 1, 1));
    EXPECT(guest_go(a, 2) == DRAPE_OK && is(s, 0, 0, 1, 1));
    EXPECT(recall_save(a, &changed) && recall_load(a, &plain) == DRAPE_OK);
    EXPECT(is(s, 0, 0, 0, 0));
    EXPECT(recall_load(a, &changed) == DRAPE_OK && is(s, 0, 0, 1, 1));
    EXPECT(drape_set_material(a, 0, &s->of[0][1]) == DRAPE_OK);
    EXPECT(drape_set_wind(a, &s->wind[0]) == DRAPE_OK);
    EXPECT(drape_set_gravity(a, s->gravity[0]) == DRAPE_OK);
    EXPECT(is(s, 0, 1, 1, 0));
    EXPECT(drape_record(a, NULL, NULL) == DRAPE_OK);
    EXPECT(recall_load(b, &changed) == DRAPE_OK && is(s, 1, 0, 1, 1));
    EXPECT(drape_replay(b, recall_read, &log, NULL) == 1);
    EXPECT(is(s, 1, 0, 1, 1)); /* as when this step was made */
    EXPECT(drape_replay(b, recall_read, &log, NULL) == 1);
    EXPECT(drape_replay(b, recall_read, &log, NULL) == 0);
    EXPECT(is(s, 1, 1, 1, 0));
    return NULL;
}

/* Cloths that stay keep their material under another number; a new one has its
 * own. */
static const char *move_bodies(struct settings *s)
{
    drape_world *a = s->world[0];
    drape_cloth high = s->t.cloth[0];
    high.pins = NULL;
    high.n_pins = 0;
    high.origin[1] = 0.5;
    high.material.friction = 0.11;
    EXPECT(drape_set_material(a, 1, &s->of[1][1]) == DRAPE_OK);
    EXPECT(drape_set_wind(a, &s->wind[1]) == DRAPE_OK);
    EXPECT(drape_set_gravity(a, s->gravity[1]) == DRAPE_OK);
    EXPECT(drape_add_cloth(a, &high, NULL) == 2 && is(s, 0, 1, 1, 1));
    EXPECT(made_of(a, 2, &high.material));
    EXPECT(drape_remove(a, 0) == DRAPE_OK && blown_by(a, &s->wind[1]));
    EXPECT(pulled_by(a, s->gravity[1]));
    EXPECT(made_of(a, 0, &s->of[1][1]) && made_of(a, 1, &high.material));
    EXPECT(!made_of(a, 2, &high.material)); /* there is no such cloth now */
    return NULL;
}

const char *test_api_settings(void)
{
    static struct settings s;
    const char *what = NULL;
    for (int backend = DRAPE_REF; backend <= DRAPE_GPU && !what; backend++) {
        what = define(&s, backend);
        what = what ? what : set_and_load(&s);
        what = what ? what : move_bodies(&s);
        for (int k = 0; k < 2; k++)
            drape_destroy(s.world[k]);
    }
    return what;
}
