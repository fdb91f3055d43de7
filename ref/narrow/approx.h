/* SPDX-License-Identifier: Apache-2.0 */
/* Truncated big integers: only the leading words are kept, with an error bound.
 * Most signs are certain from a few words, so the exact tier seldom computes
 * with full length. spec/narrow/narrow.md §6.6 */
#ifndef REF_APPROX_H
#define REF_APPROX_H

#include "ref/narrow/big.h"

/* Number of words that are kept at first. */
#define APPROX_FEW 8
/* Returned as the sign of a number whose error bound includes 0. */
#define APPROX_UNKNOWN 2
/* From this many words on, residues modulo APPROX_PRIME are computed. */
#define APPROX_REST 32
#define APPROX_PRIME UINT32_C(0xfffffffb)

/* A number that differs from m by at most err, in units of 2^(32 low). err <
 * 2^16. */
struct approx {
    struct big m;
    int low;
    uint32_t err;  /* 0: m is the number */
    uint32_t rest; /* residue of the number; a hint only */
};

/* Returns a modulo APPROX_PRIME, the largest prime below 2^32. */
uint32_t approx_rest(struct big a);
/* Results keep about m->keep leading words. A shorter result of exact operands
 * is exact. */
struct approx approx_of(const struct big_arena *m, struct big a);
/* Truncates a to APPROX_FEW words. */
struct approx approx_few(struct approx a);
struct approx approx_add(struct big_arena *m, struct approx a, struct approx b);
struct approx approx_sub(struct big_arena *m, struct approx a, struct approx b);
struct approx approx_mul(struct big_arena *m, struct approx a, struct approx b);
struct approx approx_times(struct big_arena *m, struct approx a, uint32_t k);
struct approx approx_negate(struct approx a);
/* Returns -1, 0, 1 or APPROX_UNKNOWN. */
int approx_sign(struct approx a);
/* As approx_sign. Where the sign is unknown and the residue is 0, the number is
 * probably 0: then m->keep is raised so that the next attempt truncates
 * nothing. */
int approx_decide(struct big_arena *m, struct approx a);

#endif
