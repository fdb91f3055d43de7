/* SPDX-License-Identifier: Apache-2.0 */
/* Which stages a scene has, and why. Made once; the step obeys it. */
#ifndef REF_PLAN_H
#define REF_PLAN_H

#include <stdbool.h>

#include "spec/drape.h"

struct world;

/* What a scene uses. Everything else follows from it. */
struct plan {
    bool led;       /* pins or obstacles that move */
    bool wind;      /* air with drag or lift */
    bool implicit;  /* a linear system */
    bool history;   /* the state before the last, for BDF2 */
    int newton;     /* linear systems of a motion, at most; explicit: 0 */
    bool self;      /* cloth can meet cloth */
    bool obstacles; /* cloth can meet an obstacle */
    bool collides;  /* either */
    bool warm;      /* contacts press on in the next slice: warm.md */
};

struct plan plan_make(const drape_def *def);
/* Whether this is wind at all. */
bool plan_windy(const drape_wind *wind);
/* As drape_plan. */
int plan_rows(const struct world *w, drape_plan_row *row, int capacity);

#endif
