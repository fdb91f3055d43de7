/* SPDX-License-Identifier: Apache-2.0 */
/* Fuzzes drape_replay with damaged logs, most of them with right hashes: a log
 * is refused where it cannot be, and else the world goes on. The first byte
 * selects the world; its highest bit leaves the hashes as they are. An input of
 * one byte stands for a log of that world's own. */
#include <stdlib.h>
#include <time.h>

#include "fuzz/damage.h"
#include "ref/api/record.h"

enum { AS_IT_IS = 128, PATIENCE = 30, LOG_MOST = 8000, VERTICES = 1 << 9 };

/* Calls number k of those that a log can hold, with data of the world. */
static void call(const struct small *s, drape_world *world, unsigned k)
{
    static double x[VERTICES][3], v[VERTICES][3];
    const double at[3] = {0, 0.001, 0}, gravity[3] = {0.1, -9, 0};
    const drape_wind wind = {{1, 0, 2}, 1.2, 1, 0.3};
    const int32_t pins[2] = {4, 5};
    drape_material m = s->cloth[0].material;
    m.friction += 0.125;
    if (drape_vertices(world) > VERTICES)
        return;
    drape_read(world, x, v);
    int64_t plate = drape_first_vertex(world, s->def.n_cloths);
    switch (k) {
    case 0:
        drape_set_wind(world, &wind);
        break;
    case 1:
        drape_set_gravity(world, gravity);
        break;
    case 2:
        drape_set_material(world, 0, &m);
        break;
    case 3:
        drape_set_positions(world, 1, 3, (const double(*)[3])x + 1, NULL);
        break;
    case 4:
        drape_set_velocities(world, 2, 3, (const double(*)[3])v + 2);
        break;
    case 5:
        drape_set_pins(world, 0, 2, pins, (const double(*)[3])x + 4);
        break;
    case 6:
        if (s->def.n_obstacles)
            drape_set_obstacle(world, 0, (const double(*)[3])x + plate);
        break;
    case 7:
        drape_set_pose(world, 0, at, NULL, NULL);
        break;
    case 8:
        drape_wake(world);
        break;
    case 9:
        drape_add_obstacle(world, &s->kind[0], NULL);
        break;
    case 10:
        drape_remove(world, 0);
        break;
    default:
        drape_add_cloth(world, &s->cloth[0], NULL);
    }
}

/* Records calls of world k, of which each world begins with another, until the
 * log is long enough. *end is the checkpoint after them. */
static bool record(const struct small *s, unsigned k, drape_world *world,
                   struct tape *log, struct tape *end)
{
    enum { CALLS = 12 };
    bool good = drape_record(world, tape_write, log) == DRAPE_OK;
    for (unsigned i = 0; i < CALLS && log->size < LOG_MOST; i++) {
        call(s, world, (i + 5 * k) % CALLS);
        drape_step(world, NULL);
    }
    good = good && drape_record(world, NULL, NULL) == DRAPE_OK;
    return good && tape_save(end, world);
}

/* Whether a record can begin at this place of a log. */
static bool begins(const struct tape *log, size_t at)
{
    const size_t magic = sizeof RECORD_MAGIC - 1;
    return log->size - at >= sizeof(struct record_head) &&
           !memcmp(log->data + at, RECORD_MAGIC, magic);
}

/* Recomputes the hashes of all records that are there whole, and of the
 * checkpoints between them. */
static void repair(struct tape *log)
{
    const size_t head = sizeof(struct record_head);
    for (size_t at = 0, next; at + head <= log->size; at = next) {
        struct record_head h;
        for (next = at + 8; next < log->size && !begins(log, next);)
            next += 8;
        next = next < log->size ? next : log->size;
        if (!begins(log, at))
            continue;
        memcpy(&h, log->data + at, sizeof h);
        if (h.kind == RECORD_CLOTH || h.kind == RECORD_MESH ||
            h.kind == RECORD_PANEL)
            h.at = record_mark(h.n);
        if (h.bytes <= log->size - at - head)
            h.check = record_check(h, log->data + at + head);
        memcpy(log->data + at, &h, sizeof h);
        if (h.kind == RECORD_STATE && next > at + head)
            damage_repair(log->data + at + head, next - at - head);
    }
}

static bool is_status(int status)
{
    return status <= 1 && status >= DRAPE_ELIMIT;
}

/* Plays the log, then goes on: each call must return a status, and a state can
 * be saved and loaded. */
static const char *play(drape_world *world, struct tape *log)
{
    double begun = (double)clock() / CLOCKS_PER_SEC;
    struct tape a = {.left = -1}, b = {.left = -1};
    drape_step_report r;
    int status;
    while ((status = drape_replay(world, tape_read, log, &r)) == 1)
        EXPECT((r.outcome & ~OUTCOME_BITS) == 0);
    EXPECT(is_status(status));
    bool good = tape_save(&a, world);
    a.at = 0;
    good = good && drape_load(world, tape_read, &a) == DRAPE_OK &&
           tape_save(&b, world) && tape_same(&a, &b);
    free(a.data);
    free(b.data);
    EXPECT(good);
    for (int k = 0; k < 2; k++)
        EXPECT(is_status(drape_step(world, &r)));
    EXPECT((double)clock() / CLOCKS_PER_SEC - begun < PATIENCE);
    return NULL;
}

/* Whether a log that begins with a state, as far as it goes, has this format
 * and a state of the world whose checkpoint is `own`. Bytes that do not begin
 * so pass. */
static bool matches(const struct tape *log, const struct tape *own)
{
    const size_t head = sizeof(struct record_head);
    const size_t family = sizeof RECORD_MAGIC - 2;
    struct record_head h;
    if (log->size < head || memcmp(log->data, RECORD_MAGIC, family) != 0)
        return true;
    memcpy(&h, log->data, sizeof h);
    return begins(log, 0) &&
           (h.kind != RECORD_STATE ||
            damage_matches(log->data + head, log->size - head, own->data));
}

/* A world's own log gives the state that the recorded world had at its end. */
static const char *play_own(drape_world *world, struct tape *log,
                            const struct tape *end)
{
    struct tape now = {.left = -1}, before = {.left = -1};
    tape_write(&before, log->data, log->size);
    repair(log);
    bool known = tape_same(&before, log);
    int status;
    while ((status = drape_replay(world, tape_read, log, NULL)) == 1)
        continue;
    bool same = tape_save(&now, world) && tape_same(&now, end);
    free(now.data);
    free(before.data);
    EXPECT(known); /* the repair writes the hashes that the library wrote */
    EXPECT(status == 0 && same);
    return NULL;
}

const char *fuzz_replay(const char *name, const uint8_t *data, size_t size)
{
    static struct small s;
    struct tape own = {.left = -1}, log = {.left = -1}, end = {.left = -1};
    const char *failed = "a world that could be made is not made again";
    (void)name;
    if (!size)
        return NULL;
    unsigned k = data[0] % DAMAGE_WORLDS;
    drape_world *world = damage_world(&s, k, &own);
    if (world && size == 1) {
        failed = "a log of a world's own cannot be recorded";
        bool good = record(&s, k, world, &log, &end);
        drape_destroy(world);
        own.size = 0;
        world = good ? damage_world(&s, k, &own) : NULL;
        failed = world ? play_own(world, &log, &end) : failed;
    } else if (world) {
        tape_write(&log, data + 1, size - 1);
        if (!(data[0] & AS_IT_IS))
            repair(&log);
        failed = play(world, &log);
        if (!failed && fuzz_kept && !matches(&log, &own))
            failed = "the log is of another format or world";
    }
    drape_destroy(world);
    free(own.data);
    free(log.data);
    free(end.data);
    if (!failed && (s.host.held || s.host.wrong))
        failed = "memory was not given back as it was taken";
    return failed;
}

size_t replay_mutate(uint8_t *data, size_t size, size_t most, uint64_t seed)
{
    static struct small s;
    struct bytes b = damage_choices(seed);
    if (size < 2 && most > 1) { /* begin with an undamaged log */
        struct tape unused = {.left = -1}, log = {.left = -1},
                    end = {.left = -1};
        data[0] = (uint8_t)pick(&b, DAMAGE_WORLDS);
        drape_world *world = damage_world(&s, data[0], &unused);
        size = 1;
        if (world && record(&s, data[0], world, &log, &end) &&
            log.size < most) {
            memcpy(data + 1, log.data, log.size);
            size += log.size;
        }
        drape_destroy(world);
        free(unused.data);
        free(log.data);
        free(end.data);
    }
    for (uint32_t n = 1 + pick(&b, 3); n && size > 1; n--)
        size = 1 + damage(&b, data + 1, size - 1, most - 1, size / 2);
    choices_free(&b);
    return size ? size : 1;
}
