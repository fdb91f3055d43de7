/* SPDX-License-Identifier: Apache-2.0 */
/* The explicit methods. spec/cloth/advance.md §2 */
#ifndef REF_EXPLICIT_H
#define REF_EXPLICIT_H

#include "ref/cloth/dynamics.h"

/* Substeps of s->method from x, v to x1, v1. DRAPE_OK or DRAPE_ELIMIT. */
int explicit_steps(struct dynamics *s);

#endif
