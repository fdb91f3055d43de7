/* SPDX-License-Identifier: Apache-2.0 */
/* What a turn of contacts and solves computes besides its stages, by the
 * reference. spec/contact/penalty.md §4 */
#ifndef REF_TURN_H
#define REF_TURN_H

#include "ref/base/stage.h"

struct world;

/* The streams of the particles of all cloths. All are [count]. */
struct turn {
    int64_t count;
    const real *w;    /* 1/kg, 0: fixed */
    const vec *force; /* N·s, of penalty */
    const vec *dv;    /* m/s, the result of the solve */
    const vec *q;     /* N·s, A dv */
    const vec *r;     /* N·s, what it left undone */
    bool moves;       /* whether dv is to be used; else g stays, too */
    vec *g;           /* N·s, A times the change so far */
    vec *given; /* out: N·s, g + r, what the contacts gave by their laws */
    vec *b;     /* out: force - g; it may be force */
    const vec *x0;
    vec *u, *v, *x1;
    uint8_t *touched;
    real span, dt; /* tau / dt; s */
};

/* Takes the streams of w->couple. DRAPE_OK or DRAPE_ENOMEM. */
int turn_make(struct world *w);
/* Takes scratch of penalty, links and warm for n contacts. DRAPE_OK or
 * DRAPE_ENOMEM. */
int turn_room(struct world *w, int64_t n);
/* g [n] begins with what presses already, or NULL: with nothing. */
void turn_begin(int64_t n, vec *g, const vec *press, real dt);
/* What the solve of the free motion left over, r [n], is the first turn's to
 * do. */
void turn_carry(int64_t n, const vec *r, vec *g);
/* b = force - g; 0 where fixed. */
void turn_load(const struct turn *s);
/* given; where the solve moves, g gains A dv, and u, v and x1 move with dv. */
void turn_move(const struct turn *s);

#endif
