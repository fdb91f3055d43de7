/* SPDX-License-Identifier: Apache-2.0 */
/* The exact tier of the narrow phase: spec/narrow/narrow.md §6. */
#ifndef REF_EXACT_H
#define REF_EXACT_H

#include <stdbool.h>
#include <stdint.h>

#include "ref/base/names.h"

/* Words of room that any finite binary64 input is decided in (§6.5), and
 * that the longest single number needs. */
#define EXACT_WORDS 65536
#define EXACT_LEAST 2048

/* Finite positions x[t][vertex][axis] of a vertex and a face (kind 0) or of
 * two edges (kind 1): *toi = floor(2^30 t) of the first contact in [0, 1] or
 * UINT32_MAX. Works in word[n], n at least EXACT_LEAST; returns the most words
 * that it held, or -1 and decides nothing where n are too few. */
int exact_first(double x[2][4][3], int kind, uint32_t *word, int n,
                uint32_t *toi);

#endif
