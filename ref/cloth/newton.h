/* SPDX-License-Identifier: Apache-2.0 */
/* The motion of an implicit integrator, on either backend: the order of its
 * stages, and Newton's method. spec/cloth/implicit.md §6 */
#ifndef REF_NEWTON_H
#define REF_NEWTON_H

#include "ref/base/backend.h"
#include "ref/base/sum.h"
#include "ref/cloth/blocks.h"
#include "ref/cloth/dynamics.h"
#include "ref/cloth/implicit.h"
#include "ref/cloth/springs.h"
#include "ref/cloth/wind.h"

/* Moves x, v to x1, v1 by the stages of a backend, which has set the streams of
 * s. DRAPE_OK or what
 * a stage returned. */
int newton_move(struct dynamics *s, const struct backend *run, struct gpu *on);

/* The parts of a step in which contacts take part, for a caller that solves the
 * system (lagrange.md): open sets the matrix and b, the imbalance of star;
 * place moves to star; balance sets b, the imbalance at x1, v1; linearise sets
 * the matrix at x1. DRAPE_OK or what a stage returned. */
int newton_open(struct dynamics *s, const struct backend *run, struct gpu *on);
int newton_place(struct dynamics *s, const struct backend *run, struct gpu *on);
int newton_balance(struct dynamics *s, const struct backend *run,
                   struct gpu *on);
int newton_linearise(struct dynamics *s, const struct backend *run,
                     struct gpu *on);

#endif
