/* SPDX-License-Identifier: Apache-2.0 */
/* A log of the calls that change a world, and the calls again from the log.
 * spec/control/control.md §7 */
#include "ref/api/record.h"

#include <string.h>

#include "ref/base/hash.h"

/* What each record begins with. */
struct head {
    char magic[4];
    uint32_t kind; /* enum record_kind */
    int64_t at, n;
    uint64_t bytes; /* that follow; of RECORD_STATE 0: a checkpoint follows,
                       which knows its length */
    uint64_t check; /* a hash of the head, with 0 here, and of these bytes */
};
/* The last character is the number of this format, and of the layout of the
 * structs of drape.h that records hold. */
static const char magic[4] = "drL2";

static uint64_t check_of(struct head h, const void *data)
{
    h.check = 0;
    uint64_t hash = hash_mix(HASH_SEED, &h, sizeof h);
    return h.bytes ? hash_mix(hash, data, h.bytes) : hash;
}

/* Copies the pieces of a call to `to`. Vectors are recorded in binary64, which
 * holds each number of either precision. */
static int gather(const drape_world *world, const struct record *call,
                  uint8_t *to)
{
    size_t n = 3 * (size_t)call->vectors;
    double *x = (double *)(void *)(to + (call->bytes + 7) / 8 * 8);
    if (call->bytes)
        memcpy(to, call->data, call->bytes);
    if (call->x.here)
        memcpy(x, call->x.here, n * sizeof *x);
    if (!call->x.there)
        return DRAPE_OK;
    size_t size = world->precision == 32 ? sizeof(float) : sizeof(double);
    int status =
        world->ops->control.fetch(world->world, x, call->x.there, n * size);
    /* from the last number on, as the numbers grow */
    for (size_t k = n; world->precision == 32 && k-- > 0;) {
        float a;
        memcpy(&a, (const char *)(const void *)x + k * sizeof a, sizeof a);
        x[k] = (double)a;
    }
    return status;
}

void record_lose(drape_world *world)
{
    world->record = NULL;
    world->lost = true;
}

void record_call(drape_world *world, struct record call)
{
    if (!world->record)
        return;
    bool given = call.x.here || call.x.there;
    struct head h = {.kind = (uint32_t)call.kind, .at = call.at, .n = call.n};
    memcpy(h.magic, magic, sizeof magic);
    h.bytes = (call.bytes + 7) / 8 * 8;
    h.bytes += given ? 24 * (uint64_t)call.vectors : 0;
    uint8_t *data = arena_take(&world->arena, ARENA_OTHER, (int64_t)h.bytes, 1);
    bool good = data && gather(world, &call, data) == DRAPE_OK;
    h.check = good ? check_of(h, data) : 0;
    good = good && !world->record(world->record_user, &h, sizeof h);
    good =
        good && (!h.bytes || !world->record(world->record_user, data, h.bytes));
    arena_give(&world->arena, data);
    if (!good)
        record_lose(world);
}

void record_state(drape_world *world)
{
    if (!world->record)
        return;
    record_call(world, (struct record){.kind = RECORD_STATE});
    if (world->record &&
        drape_save(world, world->record, world->record_user) != DRAPE_OK)
        record_lose(world);
}

int drape_record(drape_world *world, drape_write *write, void *user)
{
    if (!world)
        return DRAPE_EARG;
    bool lost = world->lost;
    world->record = write;
    world->record_user = user;
    world->lost = false;
    record_state(world);
    lost |= world->lost;
    world->lost = false;
    return lost ? DRAPE_EIO : DRAPE_OK;
}

static bool is_body(const struct head *h)
{
    return h->kind == RECORD_CLOTH || h->kind == RECORD_MESH;
}

/* The bytes that a record of this kind must have, or -1. */
static int64_t bytes_of(const drape_world *world, const struct head *h)
{
    int64_t nv = drape_vertices(world), n = h->n;
    if (is_body(h))
        return n > 0 && h->at == record_mark(n) ? n : -1;
    if (h->at < 0 || n < 0 || h->at > nv || (n > nv && h->kind != RECORD_STEP))
        return -1;
    switch (h->kind) {
    case RECORD_STATE:
    case RECORD_STEP:
    case RECORD_WAKE:
    case RECORD_REMOVE:
        return 0;
    case RECORD_WIND:
        return sizeof(drape_wind);
    case RECORD_GRAVITY:
        return 3 * sizeof(double);
    case RECORD_MATERIAL:
        return sizeof(drape_material);
    case RECORD_POSITIONS:
    case RECORD_VELOCITIES:
    case RECORD_OBSTACLE:
        return 24 * n;
    case RECORD_PINS: /* with or without vectors */
        return (int64_t)h->bytes == (n + 1) / 2 * 8 ? (n + 1) / 2 * 8
                                                    : (n + 1) / 2 * 8 + 24 * n;
    case RECORD_POSE:
        return sizeof(struct record_pose);
    default:
        return -1;
    }
}

static int pose_again(drape_world *world, int obstacle, const void *data)
{
    struct record_pose p;
    memcpy(&p, data, sizeof p);
    return drape_set_pose(world, obstacle, p.position, p.rotation, p.pivot);
}

static int pins_again(drape_world *world, const struct head *h,
                      const uint8_t *data)
{
    size_t list = ((size_t)h->n + 1) / 2 * 8;
    const void *at = h->bytes > list ? data + list : NULL;
    return drape_set_pins(world, (int)h->at, h->n,
                          (const int32_t *)(const void *)data,
                          (const double(*)[3])at);
}

/* Makes a recorded call again. */
static int again(drape_world *world, const struct head *h, const void *data)
{
    const double(*x)[3] = (const double(*)[3])data;
    int k = (int)h->at;
    switch (h->kind) {
    case RECORD_WAKE:
        drape_wake(world);
        return DRAPE_OK;
    case RECORD_WIND:
        return drape_set_wind(world, data);
    case RECORD_GRAVITY:
        return drape_set_gravity(world, *x);
    case RECORD_MATERIAL:
        return drape_set_material(world, k, data);
    case RECORD_POSITIONS:
        return drape_set_positions(world, h->at, h->n, x, NULL);
    case RECORD_VELOCITIES:
        return drape_set_velocities(world, h->at, h->n, x);
    case RECORD_PINS:
        return pins_again(world, h, data);
    case RECORD_OBSTACLE:
        return drape_set_obstacle(world, k, x);
    case RECORD_REMOVE:
        return drape_remove(world, k);
    default:
        return pose_again(world, k, data);
    }
}

static int step_again(drape_world *world, const struct head *h,
                      drape_step_report *report)
{
    drape_step_report own;
    report = report ? report : &own;
    int status = drape_step(world, report);
    if (status == DRAPE_OK && report->outcome != h->n)
        return DRAPE_EMATCH;
    return status == DRAPE_OK ? 1 : status;
}

/* Reads what follows a head, checks it, and makes the call. */
static int play(drape_world *world, drape_read_bytes *read, void *user,
                const struct head *h)
{
    int64_t bytes =
        memcmp(h->magic, magic, sizeof magic) == 0 ? bytes_of(world, h) : -1;
    if (bytes < 0 || (uint64_t)bytes != h->bytes)
        return DRAPE_EMATCH;
    struct arena arena; /* the world's own may be replaced with the world */
    arena_init(&arena, &world->arena.allocator);
    uint8_t *data = arena_take(&arena, ARENA_OTHER, bytes, 1);
    int status = data ? DRAPE_OK : DRAPE_ENOMEM;
    if (status == DRAPE_OK && bytes && read(user, data, (size_t)bytes))
        status = DRAPE_EIO;
    if (status == DRAPE_OK && check_of(*h, data) != h->check)
        status = DRAPE_EMATCH;
    if (status == DRAPE_OK && h->kind == RECORD_STATE)
        status = drape_load(world, read, user);
    else if (status == DRAPE_OK && is_body(h)) {
        status = record_body_again(world, h->kind, data, bytes);
        status = status < 0 ? status : DRAPE_OK;
    } else if (status == DRAPE_OK && h->kind != RECORD_STEP)
        status = again(world, h, data);
    world->arena.taken += arena.taken;
    arena_free(&arena);
    return status;
}

int drape_replay(drape_world *world, drape_read_bytes *read, void *user,
                 drape_step_report *report)
{
    struct head h;
    int status = DRAPE_OK;
    if (!world || !read)
        return DRAPE_EARG;
    while (status == DRAPE_OK) {
        if (read(user, &h, sizeof h))
            return 0;
        status = play(world, read, user, &h);
        if (status == DRAPE_OK && h.kind == RECORD_STEP)
            return step_again(world, &h, report);
    }
    return status;
}
