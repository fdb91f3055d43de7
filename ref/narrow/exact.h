/* SPDX-License-Identifier: Apache-2.0 */
/* Tier 3 of the narrow phase: decides any finite input in exact integer
 * arithmetic. spec/narrow/narrow.md §6 */
#ifndef REF_EXACT_H
#define REF_EXACT_H

#include <stdbool.h>
#include <stdint.h>

#include "ref/base/names.h"

/* EXACT_WORDS words of scratch suffice for any finite binary64 input (§6.5).
 * EXACT_LEAST words hold the longest single number. */
#define EXACT_WORDS 65536
#define EXACT_LEAST 2048

/* Finds the first contact of a vertex and a face (kind 0) or of two edges (kind
 * 1) from finite positions x[t][vertex][axis]. Writes *toi = floor(2^30 t), or
 * UINT32_MAX without a contact in [0, 1]. Uses the scratch word[n], n ≥
 * EXACT_LEAST. Returns the largest number of words in use; or -1 where n words
 * are too few, and then *toi is void. */
int exact_first(double x[2][4][3], int kind, uint32_t *word, int n,
                uint32_t *toi);

#endif
