/* SPDX-License-Identifier: Apache-2.0 */
/* Stages predict, rhs and update: the implicit steps of Baraff–Witkin and
 * Choi–Ko about their linear solve; stage history: what the second-order
 * one remembers. spec/cloth/implicit.md */
#ifndef REF_IMPLICIT_H
#define REF_IMPLICIT_H

#include "ref/cloth/cloth.h"

/* §1: where the velocity starts from, and about which the forces are
 * linearised. Without a past (n_past = 0) it is backward Euler. */
struct predict {
    int64_t count;        /* particles */
    const uint8_t *fixed; /* [count] 0, CLOTH_PINNED or CLOTH_ABSENT */
    const vec *x, *v;     /* [count] m, m/s */
    int64_t n_past;       /* count, or 0 */
    const vec *xp, *vp;   /* [n_past] the step before */
    const vec *to;        /* [count] m, pins at the end of the step */
    real tau;             /* s, dt, or 2/3 dt with a past */
    vec *star;            /* out: [count] m/s, velocity where dv = 0 */
    vec *back;            /* out: [n_past] m/s, at which springs damp */
    vec *q;               /* out: [n_past] m/s, star - back */
};

/* §2: b = tau·(force + press) - Σ over the springs of p of
 * block·(q_p - q_other). */
struct rhs {
    int64_t count;          /* particles */
    int32_t m, n;           /* along i and j */
    const uint8_t *fixed;   /* [count] */
    const uint8_t *springs; /* [count] bit o: forward spring o is there */
    int64_t n_blocks;       /* SPRINGS·count */
    const sym *block;       /* [n_blocks] kg, spring o of p at o·count + p */
    const vec *force;       /* [count] N */
    int64_t n_press;        /* count, or 0 */
    const vec *press;       /* [n_press] N, of contacts; warm.md */
    const vec *q;           /* [count] m/s */
    real tau;               /* s */
    vec *b;                 /* out: [count] N·s, 0 where fixed */
};

/* §3: v1 and x1 from the solver's dv. */
struct update {
    int64_t count;        /* particles */
    const uint8_t *fixed; /* [count] */
    const vec *x;         /* [count] m */
    int64_t n_past;       /* count, or 0 */
    const vec *xp;        /* [n_past] m, the step before */
    const vec *to;        /* [count] m, pins at the end of the step */
    const vec *star, *dv; /* [count] m/s */
    real tau, dt;         /* s */
    vec *x1, *v1;         /* out: [count] m, m/s */
};

/* §4: the past that the next step shall see, after contacts have changed
 * what the update gave. */
struct history {
    int64_t count;      /* particles */
    const vec *x0, *v0; /* [count] start of the step */
    const vec *x1, *v1; /* [count] as the update gave it */
    const vec *x, *v;   /* [count] as the step ended */
    real dt;            /* s */
    vec *xp, *vp;       /* out: [count] m, m/s */
};

/* All: DRAPE_OK. What is not finite stays so. */
int ref_predict(struct predict *s);
int ref_rhs(struct rhs *s);
int ref_update(struct update *s);
int ref_history(struct history *s);

#endif
