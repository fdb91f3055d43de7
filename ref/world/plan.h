/* SPDX-License-Identifier: Apache-2.0 */
/* Says which stages a scene uses, and why. The plan is made from the definition
 * when the world is made, and every step follows it. Only `prescribed` changes
 * later: where the caller moves pins or obstacles (spec/control/control.md). */
#ifndef REF_PLAN_H
#define REF_PLAN_H

#include <stdbool.h>

#include "spec/drape.h"

struct world;

/* The features that a scene uses; from these follows which stages run. */
struct plan {
    bool prescribed; /* a pin or an obstacle has a motion or frames */
    bool wind;       /* the air has a density, and drag or lift */
    bool implicit;   /* the integrator solves a linear system */
    bool history;    /* the integrator needs the state before: BDF2 */
    int newton;      /* linear systems of a motion, at most; explicit: 0 */
    bool self;       /* cloth can collide with cloth */
    bool obstacles;  /* cloth can collide with an obstacle */
    bool collides;   /* self or obstacles */
    bool solves;     /* contacts take part in the solve: lagrange.md */
};

struct plan plan_make(const drape_def *def);
/* Whether this wind can exert a force. */
bool plan_windy(const drape_wind *wind);
/* Does what drape_plan says. */
int plan_rows(const struct world *w, drape_plan_row *row, int capacity);

#endif
