/* SPDX-License-Identifier: Apache-2.0 */
/* The explicit half of ref/cloth/dynamics.c, and what both halves use.
 * spec/cloth/dynamics.md */
#ifndef REF_EXPLICIT_H
#define REF_EXPLICIT_H

#include "ref/cloth/dynamics.h"

/* Substeps of s->method from x, v to x1, v1. DRAPE_OK or DRAPE_ELIMIT. */
int dynamics_explicit(struct dynamics *s);

/* Stream 0 of work: the force at x; wind at v, the springs damp at damping,
 * or do not where that is NULL. */
void dynamics_force(struct dynamics *s, const vec *x, const vec *v,
                    const vec *damping);

/* x1 = x, v1 = v. */
void dynamics_copy(struct dynamics *s, const vec *x, const vec *v);

#endif
