/* SPDX-License-Identifier: Apache-2.0 */
/* Sorting by keys of 128 bits, for streams that need a canonical order. */
#ifndef REF_KEYS_H
#define REF_KEYS_H

#include <stdint.h>

#include "ref/base/names.h"

struct key {
    uint64_t hi, lo; /* compared in this order */
    int64_t item;    /* breaks ties, so that the order is total */
};

/* Sorts key [n] in ascending order, with spare [n] as scratch. Returns the
 * array of the two that holds the sorted keys. */
struct key *keys_sort(int64_t n, struct key *key, struct key *spare);

#endif
