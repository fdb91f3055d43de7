/* SPDX-License-Identifier: Apache-2.0 */
/* Whole numbers of which only the leading words are kept, with a bound of what
 * that loses: spec/narrow/narrow.md §6.6. */
#ifndef REF_NEAR_H
#define REF_NEAR_H

#include "ref/narrow/big.h"

/* How many words are kept at first. */
#define NEAR_FEW 8
/* The sign of a number that is not known well enough. */
#define NEAR_UNKNOWN 2
/* From as many words on, numbers' rests are kept. */
#define NEAR_REST 32
#define NEAR_PRIME UINT32_C(0xfffffffb)

/* A number within err of m, in units of 2^(32 low); err < 2^16. */
struct near {
    struct big m;
    int low;
    uint32_t err;  /* 0: m is the number */
    uint32_t rest; /* of the number modulo the prime; decides nothing */
};

/* a modulo NEAR_PRIME, the largest below 2^32. */
uint32_t near_rest(struct big a);
/* Each result has about m->keep leading words; what is shorter is exact. */
struct near near_of(const struct room *m, struct big a);
/* With NEAR_FEW words. */
struct near near_few(struct near a);
struct near near_add(struct room *m, struct near a, struct near b);
struct near near_sub(struct room *m, struct near a, struct near b);
struct near near_mul(struct room *m, struct near a, struct near b);
struct near near_times(struct room *m, struct near a, uint32_t k);
struct near near_negate(struct near a);
/* -1, 0, 1 or NEAR_UNKNOWN. */
int near_sign(struct near a);
/* The same; where it is not known, and the number is likely to be 0, the room
 * keeps all words from now on. */
int near_tell(struct room *m, struct near a);

#endif
