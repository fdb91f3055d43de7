/* SPDX-License-Identifier: Apache-2.0 */
/* Stages predict, rhs and update: an implicit step before and after its linear
 * solve. Stage imbalance: what the solve left undone, for Newton's method.
 * Stage history: the state of the step before, which methods of second order
 * need. spec/cloth/implicit.md */
#ifndef REF_IMPLICIT_H
#define REF_IMPLICIT_H

#include "ref/cloth/cloth.h"

/* §1: the velocity that the solve starts from, and the velocities at which the
 * forces are linearised. Without a past (n_past = 0) the method is backward
 * Euler. */
struct predict {
    int64_t count;        /* particles */
    const uint8_t *fixed; /* [count] 0, CLOTH_PINNED or CLOTH_ABSENT */
    const vec *x, *v;     /* [count] m, m/s */
    int64_t n_past;       /* count, or 0: none */
    const vec *xp, *vp;   /* [n_past] m, m/s, start of the step before */
    const vec *to;        /* [count] m, pins at the end of the step */
    real tau;             /* s, dt; with a past 2/3 dt */
    vec *star;            /* out: [count] m/s, velocity for dv = 0 */
    vec *back;            /* out: [n_past] m/s, velocity for stage springs */
    vec *q;               /* out: [n_past] m/s, star - back */
};

/* §2: b = tau·force - Σ over the springs of p of block·(q_p - q_other). */
struct rhs {
    int64_t count;          /* particles */
    int32_t m, n;           /* along i and j */
    const uint8_t *fixed;   /* [count] */
    const uint8_t *springs; /* [count] bit o: forward spring o is present */
    int64_t n_blocks;       /* SPRINGS·count */
    const sym *block;       /* [n_blocks] kg, spring o of p at o·count + p */
    const vec *force;       /* [count] N */
    const vec *q;           /* [count] m/s */
    real tau;               /* s */
    vec *b;                 /* out: [count] N·s, 0 where fixed */
};

/* §3: v1 and x1 from the solver's dv. */
struct update {
    int64_t count;        /* particles */
    const uint8_t *fixed; /* [count] */
    const vec *x;         /* [count] m */
    int64_t n_past;       /* count, or 0: none */
    const vec *xp;        /* [n_past] m, start of the step before */
    const vec *to;        /* [count] m, pins at the end of the step */
    const vec *star, *dv; /* [count] m/s */
    real part;            /* of dv that is taken: 1, or less, §6 */
    real tau, dt;         /* s */
    vec *x1, *v1;         /* out: [count] m, m/s */
};

/* §6: b = tau·force - mass·(v - star). */
struct imbalance {
    int64_t count;        /* particles */
    const uint8_t *fixed; /* [count] */
    const real *mass;     /* [count] kg */
    const vec *force;     /* [count] N, at the end of the step */
    const vec *v, *star;  /* [count] m/s, at the end, and for dv = 0 */
    real tau;             /* s */
    vec *b;               /* out: [count] N·s, 0 where fixed */
};

/* §4: the past for the next step, where contacts may have changed the results
 * of update. */
struct history {
    int64_t count;      /* particles */
    const vec *x0, *v0; /* [count] m, m/s, start of the step */
    const vec *x1, *v1; /* [count] m, m/s, results of update */
    const vec *x, *v;   /* [count] m, m/s, end of the step */
    int64_t n_jump;     /* count, or 0: no contact struck */
    const vec *jump;    /* [n_jump] m/s, what struck contacts changed */
    real part;          /* of jump that the past gets */
    real dt;            /* s */
    vec *xp, *vp;       /* out: [count] m, m/s */
};

/* All return DRAPE_OK. Values that are not finite propagate. */
int ref_predict(struct predict *s);
int ref_rhs(struct rhs *s);
int ref_update(struct update *s);
int ref_imbalance(struct imbalance *s);
int ref_history(struct history *s);

#endif
