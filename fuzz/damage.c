/* SPDX-License-Identifier: Apache-2.0 */
/* Mutates binary files so that most of their structure survives. */
#include "fuzz/damage.h"

#include <string.h>

#include "ref/base/hash.h"

struct bytes damage_choices(uint64_t seed)
{
    return (struct bytes){.seed = seed, .size = -1, .bench = true};
}

/* Writes a limit of an integer type of that size, in the host's byte order. */
static void put_limit(struct bytes *b, uint8_t *at, size_t bytes)
{
    double number = draw_any(b);
    float single = (float)(number > 1e38    ? 1e38
                           : number < -1e38 ? -1e38
                                            : number);
    int64_t whole = draw_int(b);
    bool real = pick(b, 2);
    if (bytes == 8 && real)
        memcpy(at, &number, 8);
    else if (bytes == 4 && real)
        memcpy(at, &single, 4);
    else
        memcpy(at, &whole, bytes);
}

static size_t somewhere(struct bytes *b, size_t size, size_t head)
{
    size_t within = pick(b, 2) && head < size ? head : size;
    return pick(b, (uint32_t)within);
}

static size_t resize(struct bytes *b, uint8_t *data, size_t size, size_t most)
{
    size_t other =
        pick(b, 2) ? pick(b, (uint32_t)size + 1) : size + 1 + pick(b, 64);
    other = other < most ? other : most;
    if (other > size)
        memset(data + size, (int)pick(b, 256), other - size);
    return other;
}

size_t damage(struct bytes *b, uint8_t *data, size_t size, size_t most,
              size_t head)
{
    if (size == 0)
        return fuzz_plain(data, size, most);
    size_t at = somewhere(b, size, head), from = somewhere(b, size, head);
    size_t bytes = (size_t)1 << pick(b, 4), n;
    switch (pick(b, 8)) {
    case 0:
        data[at] ^= (uint8_t)(1 << pick(b, 8));
        return size;
    case 1:
        n = pick(b, 64);
        n = n < size - at ? n : size - at;
        memmove(data + at, data + from, n < size - from ? n : size - from);
        return size;
    case 2:
        return resize(b, data, size, most);
    case 3:
        return fuzz_plain(data, size, most);
    default:
        at -= at % bytes;
        if (at + bytes <= size)
            put_limit(b, data + at, bytes);
        return size;
    }
}

/* Place of the checksum in a checkpoint. It is the hash of all other bytes by
 * words of eight bytes, and can be recomputed here only if all streams are
 * whole words. */
enum { CHECK = 24 };

/* Places in a checkpoint: the sign says whether the world was changed; the
 * number of entries that contacts carry on. */
enum { SIGN = 5, KEPT = 72 };

bool damage_matches(const uint8_t *data, size_t size, const uint8_t *own)
{
    size_t first = SIGN + 1, end = size < CHECK ? size : CHECK;
    if (size < first || memcmp(data, own, SIGN) != 0)
        return true;
    return !memcmp(data + first, own + first, end - first);
}

int64_t damage_kept(const uint8_t *data)
{
    int64_t kept;
    memcpy(&kept, data + KEPT, sizeof kept);
    return kept;
}

static uint64_t check_of(const uint8_t *data, size_t size)
{
    const uint64_t none = 0;
    uint64_t hash = hash_mix(HASH_SEED, data, CHECK);
    hash = hash_mix(hash, &none, sizeof none);
    return hash_mix(hash, data + CHECK + 8, size - CHECK - 8);
}

void damage_repair(uint8_t *data, size_t size)
{
    if (size < CHECK + 8)
        return;
    uint64_t check = check_of(data, size);
    memcpy(data + CHECK, &check, sizeof check);
}

bool damage_repairs(const uint8_t *data, size_t size)
{
    uint64_t check = size < CHECK + 8 ? 0 : check_of(data, size);
    return size >= CHECK + 8 && !memcmp(data + CHECK, &check, sizeof check);
}
