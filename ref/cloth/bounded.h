/* SPDX-License-Identifier: Apache-2.0 */
/* Whether a cloth's motion went well, on either backend.
 * spec/cloth/dynamics.md §3 */
#ifndef REF_BOUNDED_H
#define REF_BOUNDED_H

#include "ref/cloth/dynamics.h"

/* Decides from the energies `before` and `energy`, from whether all numbers of
 * the new state are in range, and from the longest way of a pin, m. True: sets
 * reference and surplus. False: the motion has diverged, the outcome says so,
 * and the caller puts the old state back. */
bool bounded_keeps(struct dynamics *s, bool sane, double reach);

#endif
