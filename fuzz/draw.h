/* SPDX-License-Identifier: Apache-2.0 */
/* What the targets draw from the fuzzer's choices. */
#ifndef FUZZ_DRAW_H
#define FUZZ_DRAW_H

#include "fuzz/bank.h"
#include "tests/base/choices.h"

/* The fuzzer's bytes as choices; 0s follow their end. The words must last. */
enum { DRAW_WORDS = 1 << 12 };
struct bytes draw_open(const uint8_t *data, size_t size,
                       uint32_t words[DRAW_WORDS]);

double draw_in(struct bytes *b, double lo, double hi);
/* 2^lo … 2^hi, evenly in the exponent; a quarter of them a power of two. */
double draw_scale(struct bytes *b, int lo, int hi);
/* Any number: limits and their neighbours, subnormals, not finite, any bits. */
double draw_any(struct bytes *b);
int draw_int(struct bytes *b); /* limits and their neighbours */

#endif
