/* SPDX-License-Identifier: Apache-2.0 */
/* A struct pcg with memory of its own, for a system of the tests. */
#ifndef TESTS_SOLVER_H
#define TESTS_SOLVER_H

#include "ref/solve/pcg.h"
#include "tests/solve/system.h"

/* Sets the system and the sizes of s, which depend on s->precond and
 * s->form. */
void solver_give(struct pcg *s, const struct system *a);

/* As solver_give, and allocates scratch and result; solver_close frees them. */
void solver_open(struct pcg *s, const struct system *a);
void solver_close(struct pcg *s);

#endif
