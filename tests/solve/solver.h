/* SPDX-License-Identifier: Apache-2.0 */
/* A pcg with memory of its own, for a system of the tests. */
#ifndef TESTS_SOLVER_H
#define TESTS_SOLVER_H

#include "ref/solve/pcg.h"
#include "tests/solve/system.h"

/* Sets the system and its sizes, from s->precond and s->form. */
void solver_give(struct pcg *s, const struct system *a);

/* The same with memory for scratch and result, to be freed by solver_close. */
void solver_open(struct pcg *s, const struct system *a);
void solver_close(struct pcg *s);

#endif
