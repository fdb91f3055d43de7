/* SPDX-License-Identifier: Apache-2.0 */
/* Writes a log of the calls that change a world. spec/control/control.md §7 */
#include "ref/api/record.h"

#include <string.h>

#include "ref/base/hash.h"

uint64_t record_check(struct record_head h, const void *data)
{
    h.check = 0;
    uint64_t hash = hash_mix(HASH_SEED, &h, sizeof h);
    return h.bytes ? hash_mix(hash, data, h.bytes) : hash;
}

/* Copies the pieces of a call to `to`. Vectors are recorded in binary64, which
 * holds each number of either precision. */
static int gather_pieces(const drape_world *world, const struct record *call,
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
    struct record_head h = {
        .kind = (uint32_t)call.kind, .at = call.at, .n = call.n};
    memcpy(h.magic, RECORD_MAGIC, sizeof h.magic);
    h.bytes = (call.bytes + 7) / 8 * 8;
    h.bytes += given ? 24 * (uint64_t)call.vectors : 0;
    uint8_t *data = arena_take(&world->arena, ARENA_OTHER, (int64_t)h.bytes, 1);
    bool good = data && gather_pieces(world, &call, data) == DRAPE_OK;
    h.check = good ? record_check(h, data) : 0;
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
    if (world->record && world->ops->save(world->world, world->record,
                                          world->record_user) != DRAPE_OK)
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
