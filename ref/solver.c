/* SPDX-License-Identifier: Apache-2.0 */
/* The linear system of one cloth. */
#include "ref/solver.h"

int solver_make(struct solver *s, const drape_def *def,
                const struct cloth *cloth, struct arena *arena) {
  (void)cloth;
  (void)arena;
  s->matrix = def->matrix;
  s->precond = def->precond;
  s->tolerance = def->tolerance;
  s->max_iterations = def->max_iterations;
  return DRAPE_OK;
}

int solver_solve(struct dynamics *d) {
  memset(d->dv, 0, (size_t)d->cloth->count * sizeof *d->dv);
  return DRAPE_OK;
}
