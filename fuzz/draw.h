/* SPDX-License-Identifier: Apache-2.0 */
/* Draws numbers for the targets from the fuzzer's choices. */
#ifndef FUZZ_DRAW_H
#define FUZZ_DRAW_H

#include "fuzz/bank.h"
#include "tests/base/choices.h"

/* Returns the fuzzer's bytes as a stream of choices, followed by zeros. `words`
 * must live as long as the stream. */
enum { DRAW_WORDS = 1 << 12 };
struct bytes draw_open(const uint8_t *data, size_t size,
                       uint32_t words[DRAW_WORDS]);

double draw_in(struct bytes *b, double lo, double hi);
/* Draws from 2^lo … 2^hi, uniform in the exponent; a quarter of the results are
 * powers of two. */
double draw_scale(struct bytes *b, int lo, int hi);
/* Draws any number: limits and their neighbours, subnormals, infinities and
 * NaN, or any bits. */
double draw_any(struct bytes *b);
int draw_int(struct bytes *b); /* limits and their neighbours */

#endif
