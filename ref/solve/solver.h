/* SPDX-License-Identifier: Apache-2.0 */
/* Solves the linear system of one cloth for dynamics. */
#ifndef REF_SOLVER_H
#define REF_SOLVER_H

#include "ref/base/arena.h"
#include "ref/solve/pcg.h"

struct cloth;
struct dynamics;

struct solver {
    struct pcg pcg;
    double seconds; /* out: s, of the last motion */
};

/* Sets the settings and sizes of the cloth's system, but no streams. */
void solver_size(struct pcg *p, const drape_def *def,
                 const struct cloth *cloth);

/* Takes the memory that the solver of this cloth needs. DRAPE_OK or
 * DRAPE_ENOMEM. */
int solver_make(struct solver *s, const drape_def *def,
                const struct cloth *cloth, struct arena *arena);

/* The function `solve` of struct dynamics. */
int solver_solve(struct dynamics *d);

#endif
