/* SPDX-License-Identifier: Apache-2.0 */
/* Bottom-up merge sort. The order of keys is total, so every correct sort gives
 * the same result; the device uses a radix sort. */
#include "ref/base/keys.h"

#include "ref/base/stage.h"

static bool is_less(const struct key *a, const struct key *b)
{
    if (a->hi != b->hi)
        return a->hi < b->hi;
    if (a->lo != b->lo)
        return a->lo < b->lo;
    return a->item < b->item;
}

/* Merges the sorted runs [a, m) and [m, e) of `from` into [a, e) of `to`. */
static void merge_runs(const struct key *from, struct key *to, int64_t a,
                       int64_t m, int64_t e)
{
    int64_t i = a, j = m;
    for (int64_t k = a; k < e; k++) {
        bool left = j == e || (i < m && !is_less(&from[j], &from[i]));
        to[k] = left ? from[i++] : from[j++];
    }
}

static int64_t least_of(int64_t a, int64_t b)
{
    return a < b ? a : b;
}

struct key *keys_sort(int64_t n, struct key *key, struct key *spare)
{
    for (int64_t run = 1; run < n; run *= 2) {
        int64_t merges = (n + 2 * run - 1) / (2 * run);
        EACH_ITEM
        for (int64_t k = 0; k < merges; k++) {
            int64_t a = 2 * run * k;
            merge_runs(key, spare, a, least_of(a + run, n),
                       least_of(a + 2 * run, n));
        }
        struct key *swap = key;
        key = spare;
        spare = swap;
    }
    return key;
}
