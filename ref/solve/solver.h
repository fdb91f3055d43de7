/* SPDX-License-Identifier: Apache-2.0 */
/* The linear system of one cloth, as dynamics wants it solved. */
#ifndef REF_SOLVER_H
#define REF_SOLVER_H

#include "ref/base/arena.h"
#include "ref/cloth/dynamics.h"
#include "ref/solve/pcg.h"

struct solver {
    struct pcg pcg;
    double seconds; /* out: s, of the last solve */
};

/* Settings and sizes of the cloth's system; no streams. */
void solver_size(struct pcg *p, const drape_def *def,
                 const struct cloth *cloth);

/* Takes what the solver of this cloth needs. DRAPE_OK or DRAPE_ENOMEM. */
int solver_make(struct solver *s, const drape_def *def,
                const struct cloth *cloth, struct arena *arena);

/* dynamics' solve. */
int solver_solve(struct dynamics *d);

#endif
