/* SPDX-License-Identifier: Apache-2.0 */
/* A session of random live control: it gives the same bits on both backends,
 * goes on from a checkpoint, and again from its log. spec/control/control.md
 * §6, §7 */
#include <stdio.h>

#include "ref/api/record.h"
#include "ref/base/hash.h"
#include "tests/api/guest.h"
#include "tests/base/choices.h"
#include "tests/world/recall.h"
#include "tests/world/slab.h"

enum { M = 7, N = 6, COUNT = M * N, PLATE = 4, NV = COUNT + PLATE };

/* The same scene on both backends, the log of each, and a checkpoint. */
struct session {
    struct guest s[2];
    drape_motion motion;
    drape_world *world[2];
    struct recall now[2], old, log[2];
    double x[NV][3], v[NV][3];
};

static void define(struct session *p, struct bytes *b, struct guest *s, int k)
{
    static const int integrator[] = {DRAPE_BW, DRAPE_CK, DRAPE_VERLET,
                                     DRAPE_BDF2};
    guest_make(s, k);
    s->def.precond = DRAPE_JACOBI;
    s->def.integrator = integrator[pick(b, 4)];
    if (s->def.integrator == DRAPE_VERLET)
        s->def.dt = 1e-3;
    s->def.sleep = (int)pick(b, 2);
    s->def.allow_intersecting = (int)pick(b, 2);
    static const double time[2] = {0, 0.25};
    static const double way[2][3] = {{0, 0, 0}, {0.01, 0, 0}};
    p->motion = (drape_motion){2, time, way, NULL, {0, 0, 0}};
    s->def.motions = &p->motion;
    s->def.n_motions = 1;
    s->plate.motion = (int)pick(b, 2) - 1;
    s->def.wind = (drape_wind){{0}, 1.2 * pick(b, 2), 1, 0.5};
}

static drape_world *make(const struct session *p, int k)
{
    drape_world *world;
    return drape_create(&p->s[k].def, &world, NULL) == DRAPE_OK ? world : NULL;
}

/* Sets the state of some vertices; a place may be refused. */
static int set_state(struct session *p, struct bytes *b, drape_world *w)
{
    int64_t first = pick(b, COUNT), n = pick(b, (uint32_t)(COUNT - first));
    drape_read(w, p->x, p->v);
    double by = 0.004 * pick(b, 4) - 0.003;
    for (int64_t k = 0; k < COUNT; k++) {
        p->x[k][1] += by;
        p->v[k][2] = by;
    }
    if (pick(b, 2))
        return drape_set_velocities(w, first, n,
                                    (const double(*)[3])p->v + first);
    return drape_set_positions(w, first, n, (const double(*)[3])p->x + first,
                               NULL);
}

static int set_pins(struct session *p, struct bytes *b, drape_world *w)
{
    int32_t list[3] = {(int32_t)pick(b, COUNT), (int32_t)pick(b, COUNT),
                       (int32_t)pick(b, COUNT)};
    double x[3][3];
    int64_t n = pick(b, 4);
    drape_read(w, p->x, NULL);
    for (int k = 0; k < 9; k++)
        x[k / 3][k % 3] = p->x[list[k / 3]][k % 3] + 0.001 * pick(b, 5);
    return drape_set_pins(w, 0, n, list,
                          pick(b, 3) ? (const double(*)[3])x : NULL);
}

static int set_obstacle(struct session *p, struct bytes *b, drape_world *w)
{
    drape_read(w, p->x, NULL);
    for (int k = COUNT; k < NV; k++)
        for (int i = 0; i < 3; i++)
            p->x[k][i] += 0.001 * pick(b, 5) - 0.002;
    return drape_set_obstacle(w, 0, (const double(*)[3])p->x + COUNT);
}

static int set_rest(struct session *p, struct bytes *b, drape_world *w)
{
    const double g[3] = {0.5 * pick(b, 3), -9.81, 0};
    const double at[3] = {0, 0.002 * pick(b, 3), 0}, turn[4] = {0.8, 0, 0.6, 0};
    const drape_wind wind = {
        {0.5 * pick(b, 3), 0, 0.5}, pick(b, 8) ? 1.2 : -1, 1, 0.5};
    drape_material m = p->s[0].cloth.material;
    m.stretch = 500 + 250 * pick(b, 4);
    if (m.stretch > 1000) { /* tables go into logs and checkpoints, too */
        const double warp[][2] = {{0.01, 8}, {0.04, 60}};
        memcpy(m.table[DRAPE_WARP], warp, sizeof warp);
    }
    m.friction = 0.25 * pick(b, 4);
    m.thickness = 0.001 + 0.001 * pick(b, 3);
    switch (pick(b, 5)) {
    case 0:
        return drape_set_gravity(w, g);
    case 1:
        return drape_set_material(w, 0, &m);
    case 2:
        return drape_set_wind(w, &wind);
    case 3:
        return drape_set_pose(w, 0, at, pick(b, 2) ? turn : NULL, NULL);
    default:
        drape_wake(w);
        return DRAPE_OK;
    }
}

static int call(struct session *p, struct bytes *b, drape_world *w)
{
    switch (pick(b, 8)) {
    case 0:
    case 1:
        return set_state(p, b, w);
    case 2:
        return set_pins(p, b, w);
    case 3:
    case 4:
        return set_obstacle(p, b, w);
    default:
        return set_rest(p, b, w);
    }
}

/* Both worlds have the same checkpoint; the first: p->now[0]. */
static const char *compare(struct session *p)
{
    EXPECT(recall_save(p->world[0], &p->now[0]));
    EXPECT(recall_save(p->world[1], &p->now[1]));
    EXPECT(recall_same(&p->now[0], &p->now[1]));
    ran(1);
    return NULL;
}

/* Both worlds make a step, one with a report, and are compared. */
static const char *step_both(struct session *p)
{
    drape_step_report r;
    for (int k = 0; k < 2; k++)
        EXPECT(drape_step(p->world[k], k ? &r : NULL) == DRAPE_OK);
    return compare(p);
}

static const char *turn(struct session *p, uint64_t seed, int64_t *refused)
{
    int status[2] = {0, 0};
    for (int k = 0; k < 2; k++) {
        struct bytes b = {.seed = seed, .size = -1};
        for (uint32_t n = pick(&b, 3); n; n--)
            status[k] = call(p, &b, p->world[k]);
        choices_free(&b);
    }
    EXPECT(status[0] == status[1]);
    *refused += status[0] != DRAPE_OK;
    const char *what = compare(p);
    return what ? what : step_both(p);
}

/* A fresh world goes on from the checkpoint with the same bits. */
static const char *go_on(struct session *p, int backend, uint64_t seed)
{
    int64_t unused = 0;
    drape_world *fresh = make(p, backend);
    EXPECT(fresh && recall_load(fresh, &p->now[0]) == DRAPE_OK);
    EXPECT(recall_save(fresh, &p->old) && recall_same(&p->old, &p->now[0]));
    drape_destroy(p->world[backend]);
    p->world[backend] = fresh;
    EXPECT(drape_record(fresh, recall_write, &p->log[backend]) == DRAPE_OK);
    return turn(p, seed, &unused);
}

/* A world plays the log and ends as the recorded one. */
static const char *play(struct session *p, int from, int to, int steps)
{
    drape_step_report r;
    drape_world *fresh = make(p, to);
    int n = 0, status;
    EXPECT(fresh);
    p->log[from].at = 0;
    while ((status = drape_replay(fresh, recall_read, &p->log[from], &r)) == 1)
        n++;
    EXPECT(status == 0 && n == steps);
    EXPECT(recall_save(fresh, &p->old) && recall_same(&p->old, &p->now[0]));
    drape_destroy(fresh);
    return NULL;
}

/* A damaged log is refused. */
static const char *damage(struct session *p, struct bytes *b)
{
    struct recall *log = &p->log[0];
    for (int k = 0; k < 8; k++) {
        drape_world *fresh = make(p, 0);
        size_t at = pick(b, (uint32_t)log->size);
        int status;
        log->data[at] ^= 4;
        log->at = 0;
        while ((status = drape_replay(fresh, recall_read, log, NULL)) == 1)
            continue;
        log->data[at] ^= 4;
        EXPECT(status < 0);
        drape_destroy(fresh);
        ran(1);
    }
    return NULL;
}

static const char *run(struct session *p, uint64_t seed, int64_t *refused)
{
    enum { STEPS = 8 };
    struct bytes b = {.seed = seed, .size = -1};
    memset(p, 0, sizeof *p);
    for (int k = 0; k < 2; k++) {
        struct bytes c = {.seed = seed, .size = -1};
        define(p, &c, &p->s[k], k);
        choices_free(&c);
        p->world[k] = make(p, k);
        EXPECT(p->world[k]);
        EXPECT(drape_record(p->world[k], recall_write, &p->log[k]) == DRAPE_OK);
    }
    const char *what = NULL;
    for (int k = 0; k < STEPS && !what; k++)
        what = turn(p, 1000 * seed + (uint64_t)k, refused);
    for (int k = 0; k < 2 && !what; k++) {
        what = play(p, k, !k, STEPS);
        EXPECT(what || drape_record(p->world[k], NULL, NULL) == DRAPE_OK);
    }
    if (!what)
        what = damage(p, &b);
    for (int k = 0; k < 2 && !what; k++) {
        p->log[k].size = 0;
        what = go_on(p, k, seed + 77);
    }
    for (int k = 0; k < 2; k++)
        drape_destroy(p->world[k]);
    choices_free(&b);
    return what;
}

const char *test_control_log(void)
{
    /* the kernels of both precisions are compiled from the same source */
    enum { FIRST = REAL_BITS == 32 ? 1 : 5, LAST = 8 };
    static struct session p;
    static char text[200];
    int64_t refused = 0;
    for (uint64_t seed = FIRST; seed <= LAST; seed++) {
        const char *what = run(&p, seed, &refused);
        if (!what)
            continue;
        snprintf(text, sizeof text, "seed %d: %s", (int)seed, what);
        return text;
    }
    EXPECT(refused > 0);
    return NULL;
}

/* Two worlds of one backend, in a session that begins anew. */
static const char *begin(struct session *p, uint64_t seed, int backend)
{
    memset(p, 0, sizeof *p);
    for (int k = 0; k < 2; k++) {
        struct bytes b = {.seed = seed, .size = -1};
        define(p, &b, &p->s[k], backend);
        choices_free(&b);
        p->world[k] = make(p, k);
        EXPECT(p->world[k]);
    }
    return NULL;
}

/* A world whose obstacle was told a place, and whose caller may have changed
 * more, loads the checkpoint of its start, and goes on as a fresh one that
 * does. */
static const char *go_back(struct session *p, uint64_t seed, int backend)
{
    enum { TURNS = 2 };
    struct recall *start = &p->log[0];
    int64_t unused = 0;
    const char *what = begin(p, seed, backend);
    EXPECT(what || recall_save(p->world[0], start));
    for (int k = 0; k < TURNS && !what; k++) {
        struct bytes b = {.seed = seed, .size = -1};
        EXPECT(set_obstacle(p, &b, p->world[0]) == DRAPE_OK);
        choices_free(&b);
        b = (struct bytes){.seed = seed + (uint64_t)k, .size = -1};
        call(p, &b, p->world[0]);
        choices_free(&b);
        EXPECT(drape_step(p->world[0], NULL) == DRAPE_OK);
    }
    for (int k = 0; k < 2; k++)
        EXPECT(what || recall_load(p->world[k], start) == DRAPE_OK);
    for (int k = 0; k < TURNS && !what; k++)
        what = step_both(p);
    if (!what)
        what = turn(p, seed, &unused);
    for (int k = 0; k < 2; k++)
        drape_destroy(p->world[k]);
    return what;
}

/* §6: loading makes a world as the checkpoint says, whatever was changed
 * before. */
const char *test_control_back(void)
{
    enum { SEEDS = 6 };
    static struct session p;
    static char text[200];
    for (uint64_t k = 0; k < 2 * SEEDS; k++) {
        const char *what = go_back(&p, k / 2, k % 2);
        if (!what)
            continue;
        snprintf(text, sizeof text, "seed %d: %s", (int)k, what);
        return text;
    }
    return NULL;
}

static int no_room(void *user, const void *data, size_t bytes)
{
    (void)data;
    return (*(int *)user)-- <= 0 && bytes > 0;
}

/* §7: a record that cannot be written ends, and says so. */
const char *test_control_lost(void)
{
    struct guest s;
    drape_world *world;
    int room = 1000;
    guest_make(&s, DRAPE_REF);
    EXPECT(drape_create(&s.def, &world, NULL) == DRAPE_OK);
    EXPECT(drape_record(world, no_room, &room) == DRAPE_OK);
    room = 1;
    EXPECT(guest_go(world, 2) == DRAPE_OK);
    EXPECT(drape_record(world, NULL, NULL) == DRAPE_EIO);
    EXPECT(drape_record(world, NULL, NULL) == DRAPE_OK);
    room = 0;
    EXPECT(drape_record(world, no_room, &room) == DRAPE_EIO);
    drape_destroy(world);
    ran(1);
    return NULL;
}

/* Gives the first record of a log, which no bytes follow, another format: the
 * last character of its magic. Its last word is the hash of the words before
 * it and of 0. */
static void set_format(struct recall *log, int format)
{
    enum { HEAD = 40, CHECK = 32 };
    uint64_t check = 0;
    log->data[3] = (uint8_t)format;
    memcpy(log->data + CHECK, &check, sizeof check);
    check = hash_mix(HASH_SEED, log->data, HEAD);
    memcpy(log->data + CHECK, &check, sizeof check);
    log->at = 0;
}

/* §7: a log of another format is refused, also where its hashes are right, as
 * its structs may have other sizes. */
const char *test_control_format(void)
{
    static struct session p;
    EXPECT(!begin(&p, 1, DRAPE_REF));
    struct recall *log = &p.log[0];
    EXPECT(drape_record(p.world[0], recall_write, log) == DRAPE_OK);
    EXPECT(drape_step(p.world[0], NULL) == DRAPE_OK);
    for (int format = '0'; format <= '9'; format++) {
        set_format(log, format);
        int want = format == '3' ? 1 : DRAPE_EMATCH;
        EXPECT(drape_replay(p.world[1], recall_read, log, NULL) == want);
        ran(1);
    }
    for (int k = 0; k < 2; k++)
        drape_destroy(p.world[k]);
    return NULL;
}

/* A record with a right hash, of data that are all zero. */
static void forge(struct recall *log, struct record_head h)
{
    static const uint8_t none[24 * NV];
    memcpy(h.magic, RECORD_MAGIC, sizeof h.magic);
    h.check = record_check(h, none);
    log->size = log->at = 0;
    recall_write(log, &h, sizeof h);
    recall_write(log, none, (size_t)h.bytes);
}

/* §7: a log is refused before a call reads beyond what its record holds, also
 * where its hashes are right. The world has a cloth and a plate. */
const char *test_control_forged(void)
{
    static const struct record_head heads[] = {
        {.kind = RECORD_OBSTACLE, .at = 0, .n = 1, .bytes = 24},
        {.kind = RECORD_OBSTACLE, .at = 0, .n = PLATE - 1, .bytes = 72},
        {.kind = RECORD_OBSTACLE, .at = 0, .n = PLATE + 1, .bytes = 120},
        {.kind = RECORD_OBSTACLE, .at = 1, .n = PLATE, .bytes = 96},
        {.kind = RECORD_OBSTACLE, .at = 0, .n = PLATE, .bytes = 72},
        {.kind = RECORD_POSITIONS, .at = 0, .n = 2, .bytes = 24},
        {.kind = RECORD_POSITIONS, .at = 0, .n = 0, .bytes = 24},
        {.kind = RECORD_VELOCITIES, .at = 0, .n = 2, .bytes = 24},
        {.kind = RECORD_VELOCITIES, .at = -1, .n = 1, .bytes = 24},
        {.kind = RECORD_PINS, .at = 0, .n = 3, .bytes = 8},
        {.kind = RECORD_PINS, .at = 0, .n = 2, .bytes = 32},
        {.kind = RECORD_WIND, .bytes = 8},
        {.kind = RECORD_GRAVITY, .bytes = 16},
        {.kind = RECORD_MATERIAL, .bytes = 96},
        {.kind = RECORD_POSE, .bytes = 24},
        {.kind = RECORD_STEP, .bytes = 8},
        {.kind = RECORD_CLOTH, .n = 8, .bytes = 8},
        {.kind = RECORD_PANEL, .n = 8, .bytes = 8},
        {.kind = RECORD_KINDS, .bytes = 0},
        {.kind = UINT32_MAX, .bytes = 0},
    };
    static struct session p;
    static char text[64];
    struct recall *log = &p.log[0];
    EXPECT(!begin(&p, 1, DRAPE_REF));
    for (size_t k = 0; k < sizeof heads / sizeof *heads; k++) {
        forge(log, heads[k]);
        int status = drape_replay(p.world[0], recall_read, log, NULL);
        snprintf(text, sizeof text, "head %d: %d", (int)k, status);
        if (status != DRAPE_EMATCH)
            return text;
        ran(1);
    }
    forge(log, (struct record_head){
                   .kind = RECORD_OBSTACLE, .n = PLATE, .bytes = 24 * PLATE});
    EXPECT(drape_replay(p.world[0], recall_read, log, NULL) == 0);
    for (int k = 0; k < 2; k++)
        drape_destroy(p.world[k]);
    return NULL;
}

/* A body whose record has words that say neither that an array is there nor
 * that it is missing, or counts that need more than it holds. */
const char *test_control_bodies(void)
{
    static struct session p;
    static uint8_t data[4096];
    drape_cloth cloth;
    drape_obstacle plate;
    EXPECT(!begin(&p, 1, DRAPE_REF));
    struct record_mesh {
        drape_obstacle o;
        uint64_t there[4];
        double x[3][3];
        int32_t tri[1][3], unused;
    } mesh = {.o = p.s[0].plate, .there = {1, 1, 0, 0}};
    mesh.o.n_vertices = 3;
    mesh.o.n_triangles = 1;
    memcpy(data, &mesh, sizeof mesh);
    EXPECT(record_obstacle_of(data, sizeof mesh, &plate) == DRAPE_OK);
    EXPECT(record_obstacle_of(data, sizeof mesh - 8, &plate) == DRAPE_EMATCH);
    EXPECT(record_obstacle_of(data, 8, &plate) == DRAPE_EMATCH);
    EXPECT(record_cloth_of(data, sizeof mesh, &cloth) == DRAPE_EMATCH);
    struct record_panel {
        drape_cloth c;
        drape_panel panel;
        uint64_t there[8];
        double rest[4][2];
        uint8_t cell[8]; /* 1, filled up to a word */
        drape_ease ease;
    } sheet = {.panel.n_eases = 1, .there = {0, 0, 0, 0, 0, 1, 1, 1}};
    drape_default_cloth(&sheet.c);
    sheet.c.m = sheet.c.n = 2;
    sheet.ease.ratio = 0.75;
    const int32_t eases[] = {1, -1, 2, INT32_MAX};
    for (int k = 0; k < 4; k++) {
        drape_panel panel;
        sheet.panel.n_eases = eases[k];
        memcpy(data, &sheet, sizeof sheet);
        EXPECT(record_panel_of(data, sizeof sheet, &cloth, &panel) ==
               (k ? DRAPE_EMATCH : DRAPE_OK));
        EXPECT(k || (cloth.panel == &panel && panel.eases->ratio == 0.75));
        EXPECT(record_panel_of(data, sizeof sheet - 8, &cloth, &panel) ==
               DRAPE_EMATCH);
        EXPECT(record_panel_of(data, 8, &cloth, &panel) == DRAPE_EMATCH);
    }
    mesh.there[1] = 2;
    memcpy(data, &mesh, sizeof mesh);
    EXPECT(record_obstacle_of(data, sizeof mesh, &plate) == DRAPE_EMATCH);
    mesh.there[1] = 1;
    mesh.o.n_vertices = INT32_MAX;
    memcpy(data, &mesh, sizeof mesh);
    EXPECT(record_obstacle_of(data, sizeof mesh, &plate) == DRAPE_EMATCH);
    for (int k = 0; k < 2; k++)
        drape_destroy(p.world[k]);
    ran(1);
    return NULL;
}

/* Calls that leave everything as it is. */
static int call_again(drape_world *w, const struct slab *d, int kind)
{
    enum { SHEET = SLAB_SMALL * SLAB_SMALL };
    static double x[SHEET + 8][3], v[SHEET + 8][3];
    const double zero[3] = {0};
    drape_read(w, x, v);
    switch (kind) {
    case 0:
        drape_wake(w);
        return DRAPE_OK;
    case 1:
        return drape_set_wind(w, &d->def.wind);
    case 2:
        return drape_set_gravity(w, d->def.gravity);
    case 3:
        return drape_set_material(w, 0, &d->cloth.material);
    case 4:
        return drape_set_positions(w, 0, SHEET, (const double(*)[3])x, NULL);
    case 5:
        return drape_set_velocities(w, 0, SHEET, (const double(*)[3])v);
    case 6:
        return drape_set_pins(w, 0, 0, NULL, NULL);
    case 7:
        return drape_set_obstacle(w, 0, (const double(*)[3])x + SHEET);
    case 8:
        return drape_set_pose(w, 0, zero, NULL, NULL);
    default:
        return drape_remove(w, 1);
    }
}

enum { CALLS = 10, TIRED = 200 };

/* Steps until the scene is asleep: how many steps were not. */
static int doze(drape_world *world)
{
    drape_step_report r = {0};
    for (int k = 0; k < TIRED; k++)
        if (drape_step(world, &r) != DRAPE_OK || r.outcome & DRAPE_ASLEEP)
            return r.outcome & DRAPE_ASLEEP ? k : TIRED;
    return TIRED;
}

/* §1, §7: each call wakes a scene that sleeps, and so does the call that a log
 * repeats. */
const char *test_control_wakes(void)
{
    static const double still[2][3] = {{0}};
    static struct recall log;
    struct slab d;
    slab_small(&d, DRAPE_BW, 0.375);
    d.def.gravity[1] = 0;
    d.motion.position = still;
    drape_world *world = slab_world(&d), *other = slab_world(&d);
    EXPECT(world && other && doze(world) < TIRED);
    log.size = log.at = 0;
    EXPECT(drape_record(world, recall_write, &log) == DRAPE_OK);
    for (int k = 0; k < CALLS; k++) {
        EXPECT(doze(world) == 0);
        EXPECT(call_again(world, &d, k) == DRAPE_OK);
        int awake = doze(world);
        EXPECT(0 < awake && awake < TIRED);
        ran(1);
    }
    EXPECT(drape_record(world, NULL, NULL) == DRAPE_OK);
    int status, asleep = 0, steps = 0;
    drape_step_report r;
    while ((status = drape_replay(other, recall_read, &log, &r)) == 1) {
        asleep += (r.outcome & DRAPE_ASLEEP) != 0;
        steps++;
    }
    EXPECT(status == 0 && asleep == 2 * CALLS && steps > asleep + CALLS);
    drape_destroy(world);
    drape_destroy(other);
    return NULL;
}
