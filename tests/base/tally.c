/* SPDX-License-Identifier: Apache-2.0 */
/* What tests report to the harness while they run, and the options of check. */
#include "tests/base/tally.h"

#include "tests/base/modes.h"

struct tally tally;
struct options options = {.cases = 3, .seed = 1};

void ran(int64_t cases)
{
    tally.cases += cases;
}

const char *skip(const char *why)
{
    tally.skipped = why;
    return NULL;
}

uint64_t hash_bytes(uint64_t hash, const void *data, size_t bytes)
{
    const uint8_t *p = data;
    for (size_t k = 0; k < bytes; k++)
        hash = (hash ^ p[k]) * UINT64_C(1099511628211);
    return hash;
}
