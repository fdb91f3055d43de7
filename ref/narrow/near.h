/* SPDX-License-Identifier: Apache-2.0 */
/* Truncated big integers: only the leading words are kept, with an error bound.
 * Most signs are certain from a few words, so the exact tier seldom computes
 * with full length. spec/narrow/narrow.md §6.6 */
#ifndef REF_NEAR_H
#define REF_NEAR_H

#include "ref/narrow/big.h"

/* Number of words that are kept at first. */
#define NEAR_FEW 8
/* Returned as the sign of a number whose error bound includes 0. */
#define NEAR_UNKNOWN 2
/* From this many words on, residues modulo NEAR_PRIME are computed. */
#define NEAR_REST 32
#define NEAR_PRIME UINT32_C(0xfffffffb)

/* A number that differs from m by at most err, in units of 2^(32 low). err <
 * 2^16. */
struct near {
    struct big m;
    int low;
    uint32_t err;  /* 0: m is the number */
    uint32_t rest; /* residue of the number; a hint only */
};

/* Returns a modulo NEAR_PRIME, the largest prime below 2^32. */
uint32_t near_rest(struct big a);
/* Results keep about m->keep leading words. A shorter result of exact operands
 * is exact. */
struct near near_of(const struct big_arena *m, struct big a);
/* Truncates a to NEAR_FEW words. */
struct near near_few(struct near a);
struct near near_add(struct big_arena *m, struct near a, struct near b);
struct near near_sub(struct big_arena *m, struct near a, struct near b);
struct near near_mul(struct big_arena *m, struct near a, struct near b);
struct near near_times(struct big_arena *m, struct near a, uint32_t k);
struct near near_negate(struct near a);
/* Returns -1, 0, 1 or NEAR_UNKNOWN. */
int near_sign(struct near a);
/* As near_sign. Where the sign is unknown and the residue is 0, the number is
 * probably 0: then m->keep is raised so that the next attempt truncates
 * nothing. */
int near_tell(struct big_arena *m, struct near a);

#endif
