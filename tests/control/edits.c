/* SPDX-License-Identifier: Apache-2.0 */
/* Changes of bodies that are refused, that lack memory, and that a log repeats.
 * spec/control/control.md §7, §9 */
#include <stdio.h>

#include "tests/control/troupe.h"

static const char *unchanged(drape_world *a, const struct recall *before)
{
    static struct recall after;
    EXPECT(recall_save(a, &after) && recall_same(before, &after));
    ran(1);
    return NULL;
}

/* §9.4: a body that intersects is refused by bodies and first pair. */
static const char *check_start(int backend)
{
    static struct recall before;
    struct troupe t;
    drape_error error;
    troupe_make(&t, DRAPE_BW, backend);
    drape_world *a = troupe_world(&t);
    EXPECT(a && guest_go(a, 3) == DRAPE_OK && recall_save(a, &before));
    drape_cloth low = t.cloth[1];
    low.x = NULL;
    low.origin[1] = -0.001;
    low.u[1] = 0.6;
    low.u[0] = 0.8;
    EXPECT(drape_add_cloth(a, &low, &error) == DRAPE_ESTART);
    EXPECT(strstr(error.text, "cloth 2 triangle"));
    const char *what = unchanged(a, &before);
    drape_obstacle across = t.obstacle[0];
    static const double x[4][3] = {
        {-.05, -.01, -.06}, {.05, .5, -.06}, {-.05, 0, .06}, {.05, .5, .06}};
    across.x = x;
    EXPECT(what || drape_add_obstacle(a, &across, &error) == DRAPE_ESTART);
    EXPECT(what || strstr(error.text, "obstacle 2 triangle"));
    EXPECT(what || drape_add_obstacle(a, &across, NULL) == DRAPE_ESTART);
    what = what ? what : unchanged(a, &before);
    /* two obstacles may intersect each other */
    across = t.obstacle[1];
    EXPECT(what || drape_add_obstacle(a, &across, &error) == 2);
    drape_destroy(a);
    return what;
}

/* §9.4: pairs of the bodies that stay remain the state's, until a removal ends
 * them; where such a start is allowed a new body may bring more. */
static const char *check_pairs(int backend)
{
    struct troupe t;
    drape_step_report r;
    troupe_make(&t, DRAPE_BW, backend);
    t.cloth[0].origin[1] = -0.03;
    t.cloth[0].u[1] = 0.28;
    t.cloth[0].u[0] = 0.96;
    t.def.allow_intersecting = 1;
    troupe_drop(&t, 1);
    struct troupe less = t;
    troupe_drop(&less, 1);
    drape_world *a = troupe_world(&t), *b = troupe_world(&less);
    EXPECT(a && b && drape_remove(a, 2) == DRAPE_OK);
    EXPECT(drape_step(a, &r) == DRAPE_OK && r.intersecting > 0);
    EXPECT(drape_add_obstacle(a, &t.obstacle[1], NULL) == 1);
    EXPECT(drape_remove(a, 1) == DRAPE_OK);
    EXPECT(drape_step(a, &r) == DRAPE_OK && !(r.outcome & DRAPE_TRAPPED));
    EXPECT(drape_add_obstacle(b, &t.obstacle[0], NULL) == 1);
    EXPECT(drape_step(b, &r) == DRAPE_OK && r.intersecting > 0);
    drape_destroy(a);
    drape_destroy(b);
    ran(1);
    return NULL;
}

const char *test_edits_start(void)
{
    const char *what = NULL;
    for (int backend = 0; backend < 2 && !what; backend++)
        what = check_start(backend);
    for (int backend = 0; backend < 2 && !what; backend++)
        what = check_pairs(backend);
    return what;
}

/* A change for which there is no memory changes nothing, wherever it fails, and
 * the memory of the try is given back. kind: 0: a cloth comes, 1: the obstacle
 * goes; there: what fails is the device's memory. */
static const char *check_memory(int backend, int kind, bool there)
{
    static struct recall before;
    struct guest s;
    drape_world *a;
    guest_make(&s, backend);
    drape_cloth high = s.cloth;
    high.origin[1] = 0.1;
    EXPECT(drape_create(&s.def, &a, NULL) == DRAPE_OK);
    EXPECT(recall_save(a, &before));
    size_t held[2] = {s.host.held, s.device.held};
    struct counting_allocator *p = there ? &s.device : &s.host;
    const char *what = NULL;
    int64_t fails = 0;
    for (int status = DRAPE_ENOMEM; status < 0 && !what; fails++) {
        p->most = p->calls + fails;
        status = kind ? drape_remove(a, 1) : drape_add_cloth(a, &high, NULL);
        p->most = INT64_MAX;
        if (status >= 0)
            break;
        EXPECT(status == DRAPE_ENOMEM);
        EXPECT(s.host.held == held[0] && s.device.held == held[1]);
        what = unchanged(a, &before);
    }
    EXPECT(what || (fails > 20 && guest_go(a, 2) == DRAPE_OK));
    drape_destroy(a);
    EXPECT(s.host.held == 0 && s.device.held == 0);
    return what;
}

const char *test_edits_memory(void)
{
    const char *what = NULL;
    for (int kind = 0; kind < 2 && !what; kind++) {
        what = check_memory(DRAPE_REF, kind, false);
        what = what ? what : check_memory(DRAPE_GPU, kind, false);
        what = what ? what : check_memory(DRAPE_GPU, kind, true);
    }
    return what;
}

/* A checkpoint for which there is no memory changes nothing, and a world whose
 * memory has run out can still be saved. */
static const char *check_load(int backend, bool there)
{
    static struct recall before, later, after;
    struct guest s;
    drape_world *a, *b;
    guest_make(&s, backend);
    EXPECT(drape_create(&s.def, &a, NULL) == DRAPE_OK);
    EXPECT(guest_go(a, 8) == DRAPE_OK && recall_save(a, &later));
    drape_destroy(a);
    EXPECT(drape_create(&s.def, &b, NULL) == DRAPE_OK);
    EXPECT(recall_save(b, &before) && before.size < later.size);
    struct counting_allocator *p = there ? &s.device : &s.host;
    const char *what = NULL;
    int64_t fails = 0;
    for (int status = DRAPE_ENOMEM; status < 0 && !what; fails++) {
        p->most = p->calls + fails;
        status = recall_load(b, &later);
        p->most = INT64_MAX;
        if (status >= 0)
            break;
        EXPECT(status == DRAPE_ENOMEM);
        what = unchanged(b, &before);
    }
    EXPECT(what || (recall_save(b, &after) && recall_same(&later, &after)));
    EXPECT(what || fails >= (there ? 1 : 4));
    drape_destroy(b);
    return what;
}

const char *test_checkpoint_memory(void)
{
    const char *what = check_load(DRAPE_REF, false);
    what = what ? what : check_load(DRAPE_GPU, false);
    return what ? what : check_load(DRAPE_GPU, true);
}

/* The log of a session in which bodies come and go. */
struct session {
    struct troupe t;
    struct recall log, end, other;
};

enum { STEPS = 10 };

static const char *record(struct session *p, drape_world *a)
{
    const double up[3] = {0, 0.001, 0};
    const int32_t pins[2] = {1, 2};
    const drape_pin none = {0, 0, -1};
    drape_cloth high = p->t.cloth[0];
    drape_obstacle plate = p->t.obstacle[0];
    EXPECT(drape_record(a, recall_write, &p->log) == DRAPE_OK);
    EXPECT(guest_go(a, 2) == DRAPE_OK);
    high.origin[1] = 0.05;
    high.pins = &none; /* an empty array, which is not a missing one */
    high.n_pins = 0;
    EXPECT(drape_add_cloth(a, &high, NULL) == 2);
    EXPECT(drape_set_pins(a, 2, 2, pins, NULL) == DRAPE_OK);
    EXPECT(guest_go(a, 2) == DRAPE_OK);
    EXPECT(drape_remove(a, 0) == DRAPE_OK);
    EXPECT(drape_remove(a, 9) == DRAPE_EARG); /* not in the log */
    EXPECT(guest_go(a, 2) == DRAPE_OK);
    static double low[3][4][3];
    static const double times[3] = {-0.1, 0.05, 0.2};
    for (int k = 0; k < 36; k++)
        (&low[0][0][0])[k] = plate.x[k % 12 / 3][k % 3] -
                             (k % 3 == 1 ? 0.3 + 0.01 * (k / 12) : 0);
    plate.frames = 3;
    plate.between = DRAPE_CUBIC;
    plate.frame_time = times;
    plate.frame = (const double(*)[3])low[0];
    EXPECT(drape_add_obstacle(a, &plate, NULL) == 2);
    plate.frame_time = NULL;
    plate.frames = 0;
    plate.x = (const double(*)[3])low[1];
    EXPECT(drape_add_obstacle(a, &plate, NULL) == 3);
    EXPECT(drape_set_pose(a, 3, up, NULL, NULL) == DRAPE_OK);
    EXPECT(guest_go(a, 2) == DRAPE_OK);
    EXPECT(drape_remove(a, 2) == DRAPE_OK);
    EXPECT(guest_go(a, 2) == DRAPE_OK && recall_save(a, &p->end));
    return NULL;
}

static const char *play(struct session *p, int backend)
{
    drape_step_report r;
    int steps = 0, status, cloths;
    p->t.def.backend = backend;
    p->log.at = 0;
    drape_world *b = troupe_world(&p->t);
    EXPECT(b);
    while ((status = drape_replay(b, recall_read, &p->log, &r)) == 1)
        steps++;
    EXPECT(status == 0 && steps == STEPS);
    EXPECT(drape_bodies(b, &cloths) == 5 && cloths == 2);
    EXPECT(recall_save(b, &p->other) && recall_same(&p->end, &p->other));
    drape_destroy(b);
    ran(1);
    return NULL;
}

/* A log of which one bit is wrong, anywhere, is refused. */
static const char *damage(struct session *p)
{
    uint64_t seed = 7;
    p->t.def.backend = DRAPE_REF;
    for (int k = 0; k < 60; k++) {
        seed = seed * UINT64_C(6364136223846793005) + 1;
        size_t at = (size_t)(seed >> 33) % p->log.size;
        uint8_t bit = (uint8_t)(1 << (seed >> 40) % 8);
        drape_world *b = troupe_world(&p->t);
        int status;
        EXPECT(b);
        p->log.at = 0;
        p->log.data[at] ^= bit;
        while ((status = drape_replay(b, recall_read, &p->log, NULL)) == 1)
            continue;
        p->log.data[at] ^= bit;
        drape_destroy(b);
        EXPECT(status < 0);
        ran(1);
    }
    return NULL;
}

const char *test_edits_log(void)
{
    static struct session p;
    const char *what = NULL;
    for (int backend = 0; backend < 2 && !what; backend++) {
        memset(&p, 0, sizeof p);
        troupe_make(&p.t, backend ? DRAPE_BDF2 : DRAPE_BW, backend);
        drape_world *a = troupe_world(&p.t);
        EXPECT(a);
        what = record(&p, a);
        drape_destroy(a);
        what = what ? what : play(&p, backend);
        what = what ? what : play(&p, !backend);
    }
    return what ? what : damage(&p);
}

/* Copies of a sheet's and a plate's arrays, at places of their own. */
struct copies {
    double x[TROUPE_PLATE][3];
    int32_t tri[2][3];
    uint8_t hole[TROUPE_COUNT], cut[TROUPE_COUNT];
    drape_pin pin[1];
};

static void move_to(struct copies *to, drape_cloth *sheet,
                    drape_obstacle *plate)
{
    memcpy(to->x, plate->x, sizeof to->x);
    memcpy(to->tri, plate->tri, sizeof to->tri);
    for (int k = 0; k < TROUPE_PLATE; k++)
        to->x[k][1] -= 1;
    memcpy(to->hole, sheet->hole, TROUPE_COUNT);
    memcpy(to->cut, sheet->cut, (TROUPE_M - 1) * (TROUPE_N - 1));
    to->pin[0] = (drape_pin){0, TROUPE_N - 1, -1};
    plate->x = (const double(*)[3])to->x;
    plate->tri = (const int32_t(*)[3])to->tri;
    sheet->hole = to->hole;
    sheet->cut = to->cut;
    sheet->pins = to->pin;
    sheet->n_pins = 1;
    sheet->origin[1] += 1;
}

/* §7: the bytes of a log are those of what a world was told, wherever it lay.
 */
const char *test_edits_bytes(void)
{
    static struct recall log[2];
    static struct copies copies[2];
    for (int k = 0; k < 2; k++) {
        struct troupe t;
        troupe_make(&t, DRAPE_BW, DRAPE_REF);
        drape_world *world = troupe_world(&t);
        drape_cloth sheet = t.cloth[0];
        drape_obstacle plate = t.obstacle[0];
        move_to(&copies[k], &sheet, &plate);
        EXPECT(drape_record(world, recall_write, &log[k]) == DRAPE_OK);
        size_t before = log[k].size;
        EXPECT(drape_add_obstacle(world, &plate, NULL) > 0);
        EXPECT(drape_add_cloth(world, &sheet, NULL) > 0);
        EXPECT(drape_record(world, NULL, NULL) == DRAPE_OK);
        EXPECT(log[k].size >= before + sizeof copies->x + sizeof copies->tri);
        drape_destroy(world);
        ran(1);
    }
    EXPECT(recall_same(&log[0], &log[1]));
    return NULL;
}
