/* SPDX-License-Identifier: Apache-2.0 */
/* Makes the calls of a log again. spec/control/control.md §7 */
#include <string.h>

#include "ref/api/record.h"

static bool is_body(const struct record_head *h)
{
    return h->kind == RECORD_CLOTH || h->kind == RECORD_MESH ||
           h->kind == RECORD_PANEL;
}

/* The vertices that the call of a record about an obstacle will read, or -1. */
static int64_t vertices_of(const drape_world *world, int64_t obstacle)
{
    if (obstacle >= world->bodies - world->cloths)
        return -1;
    int body = world->cloths + (int)obstacle;
    return drape_first_vertex(world, body + 1) -
           drape_first_vertex(world, body);
}

/* The bytes that a record of this kind must have, or -1. What the call reads is
 * checked here and not by the hash, which anybody can compute. */
static int64_t bytes_of(const drape_world *world, const struct record_head *h)
{
    int64_t nv = drape_vertices(world), n = h->n;
    if (h->kind == RECORD_SEAM) {
        bool fits =
            h->at >= 0 && h->at <= INT32_MAX && n > 0 &&
            n == world->ops->control.seam_points(world->world, (int)h->at);
        return !fits ? -1 : h->bytes ? 24 * n : 0;
    }
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
    case RECORD_OBSTACLE:
        return n == vertices_of(world, h->at) ? 24 * n : -1;
    case RECORD_POSITIONS:
    case RECORD_VELOCITIES:
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

/* Adds a body again. Returns its number, or a negative status. */
static int body_again(drape_world *world, uint32_t kind, const uint8_t *data,
                      int64_t bytes)
{
    drape_cloth cloth;
    drape_panel panel;
    drape_obstacle obstacle;
    int status = DRAPE_OK;
    if (kind == RECORD_MESH)
        status = record_obstacle_of(data, bytes, &obstacle);
    else if (kind == RECORD_PANEL)
        status = record_panel_of(data, bytes, &cloth, &panel);
    else
        status = record_cloth_of(data, bytes, &cloth);
    if (status != DRAPE_OK)
        return status;
    return kind == RECORD_MESH ? drape_add_obstacle(world, &obstacle, NULL)
                               : drape_add_cloth(world, &cloth, NULL);
}

static int pose_again(drape_world *world, int obstacle, const void *data)
{
    struct record_pose p;
    memcpy(&p, data, sizeof p);
    return drape_set_pose(world, obstacle, p.position, p.rotation, p.pivot);
}

static int pins_again(drape_world *world, const struct record_head *h,
                      const uint8_t *data)
{
    size_t list = ((size_t)h->n + 1) / 2 * 8;
    const void *at = h->bytes > list ? data + list : NULL;
    return drape_set_pins(world, (int)h->at, h->n,
                          (const int32_t *)(const void *)data,
                          (const double(*)[3])at);
}

/* Makes a recorded call again. */
static int repeat_call(drape_world *world, const struct record_head *h,
                       const void *data)
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
    case RECORD_SEAM:
        return drape_seam_target(world, k, h->bytes ? x : NULL);
    default:
        return pose_again(world, k, data);
    }
}

static int step_again(drape_world *world, const struct record_head *h,
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
static int play_record(drape_world *world, drape_read_bytes *read, void *user,
                       const struct record_head *h)
{
    int64_t bytes = memcmp(h->magic, RECORD_MAGIC, sizeof h->magic) == 0
                        ? bytes_of(world, h)
                        : -1;
    if (bytes < 0 || (uint64_t)bytes != h->bytes)
        return DRAPE_EMATCH;
    struct arena arena; /* the world's own may be replaced with the world */
    arena_init(&arena, &world->arena.allocator);
    uint8_t *data = arena_take(&arena, ARENA_OTHER, bytes, 1);
    int status = data ? DRAPE_OK : DRAPE_ENOMEM;
    if (status == DRAPE_OK && bytes && read(user, data, (size_t)bytes))
        status = DRAPE_EIO;
    if (status == DRAPE_OK && record_check(*h, data) != h->check)
        status = DRAPE_EMATCH;
    if (status == DRAPE_OK && h->kind == RECORD_STATE)
        status = drape_load(world, read, user);
    else if (status == DRAPE_OK && is_body(h)) {
        status = body_again(world, h->kind, data, bytes);
        status = status < 0 ? status : DRAPE_OK;
    } else if (status == DRAPE_OK && h->kind != RECORD_STEP)
        status = repeat_call(world, h, data);
    world->arena.taken += arena.taken;
    arena_free(&arena);
    return status;
}

int drape_replay(drape_world *world, drape_read_bytes *read, void *user,
                 drape_step_report *report)
{
    struct record_head h;
    int status = DRAPE_OK;
    if (!world || !read)
        return DRAPE_EARG;
    while (status == DRAPE_OK) {
        if (read(user, &h, sizeof h))
            return 0;
        status = play_record(world, read, user, &h);
        if (status == DRAPE_OK && h.kind == RECORD_STEP)
            return step_again(world, &h, report);
    }
    return status;
}
