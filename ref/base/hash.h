/* SPDX-License-Identifier: Apache-2.0 */
/* The hash of fingerprints, checkpoints and traces: FNV-1a over words of eight
 * bytes, with an additional shift. The hash detects accidental changes; it is
 * not cryptographic. */
#ifndef REF_HASH_H
#define REF_HASH_H

#include <stddef.h>
#include <stdint.h>
#include <string.h>

#define HASH_SEED UINT64_C(14695981039346656037)

static inline uint64_t hash_mix(uint64_t hash, const void *data, size_t bytes)
{
    const uint8_t *p = (const uint8_t *)data;
    for (; bytes >= 8; bytes -= 8, p += 8) {
        uint64_t word;
        memcpy(&word, p, 8);
        hash = (hash ^ word) * UINT64_C(1099511628211);
        hash ^= hash >> 29;
    }
    for (; bytes; bytes--, p++)
        hash = (hash ^ *p) * UINT64_C(1099511628211);
    return hash;
}

#endif
