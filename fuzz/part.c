/* SPDX-License-Identifier: Apache-2.0 */
/* Mutates the checkpoint of a run, mostly with the checksums recomputed. */
#include <string.h>

#include "fuzz/damage.h"
#include "fuzz/files.h"

enum { HEAD = 240 }; /* bytes of the header, before the streams */

/* Returns the library's part of a run's checkpoint, which begins with its magic
 * number, or NULL if there is none. */
static uint8_t *library_part(uint8_t *data, size_t size)
{
    static const char magic[] = "drape-";
    for (size_t k = 0; k + sizeof magic < size; k += 8)
        if (!memcmp(data + k, magic, sizeof magic - 1))
            return data + k;
    return NULL;
}

/* Recomputes the library's checksum, then the checksum of the whole file, which
 * is its last eight bytes. */
static void repair(uint8_t *data, size_t size)
{
    uint64_t sum;
    if (size < sizeof sum)
        return;
    uint8_t *end = data + size - sizeof sum, *part = library_part(data, size);
    if (part && part < end)
        damage_repair(part, (size_t)(end - part));
    sum = hash_bytes(HASH_START, data, size - sizeof sum);
    memcpy(end, &sum, sizeof sum);
}

size_t checkpoint_mutate(uint8_t *data, size_t size, size_t most, uint64_t seed)
{
    struct bytes b = damage_choices(seed);
    if (size < 2)
        size = checkpoint_begin(data, size, most);
    for (uint32_t k = 1 + pick(&b, 3); k && size; k--)
        size = damage(&b, data, size, most, HEAD);
    if (pick(&b, 8))
        repair(data, size);
    choices_free(&b);
    return size ? size : 1;
}
