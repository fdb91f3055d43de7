/* SPDX-License-Identifier: Apache-2.0 */
/* The motion of an implicit integrator, on either backend: the order of its
 * stages, and Newton's method. spec/cloth/implicit.md §6 */
#ifndef REF_NEWTON_H
#define REF_NEWTON_H

#include "ref/base/sum.h"
#include "ref/cloth/blocks.h"
#include "ref/cloth/dynamics.h"
#include "ref/cloth/implicit.h"
#include "ref/cloth/springs.h"
#include "ref/cloth/wind.h"

/* The stages of a motion, by one backend; `on` is the backend's own. A function
 * of a device may queue its work and return, but not dot and solve. */
struct newton_stages {
    int (*wind)(void *on, struct wind *s);
    int (*springs)(void *on, struct springs *s);
    int (*blocks)(void *on, struct blocks *s);
    int (*predict)(void *on, struct predict *s);
    int (*rhs)(void *on, struct rhs *s);
    int (*update)(void *on, struct update *s);
    int (*imbalance)(void *on, struct imbalance *s);
    int (*dot)(void *on, struct dot *s);
    /* As the function `solve` of struct dynamics. */
    int (*solve)(void *on);
    void (*copy)(void *on, vec *to, const vec *from, size_t bytes);
    /* As trace_stage, of a stream in the backend's memory. */
    void (*trace)(void *on, const char *stage, const void *out, size_t bytes);
};

/* Moves x, v to x1, v1. The backend has set the streams of s. DRAPE_OK or what
 * a stage returned. */
int newton_move(struct dynamics *s, const struct newton_stages *run, void *on);

/* The parts of a step in which contacts take part, for a caller that solves the
 * system (lagrange.md): open sets the matrix and b, the imbalance of star;
 * place moves to star; balance sets b, the imbalance at x1, v1; linearise sets
 * the matrix at x1. DRAPE_OK or what a stage returned. */
int newton_open(struct dynamics *s, const struct newton_stages *run, void *on);
int newton_place(struct dynamics *s, const struct newton_stages *run, void *on);
int newton_balance(struct dynamics *s, const struct newton_stages *run,
                   void *on);
int newton_linearise(struct dynamics *s, const struct newton_stages *run,
                     void *on);

#endif
