/* SPDX-License-Identifier: Apache-2.0 */
/* Who is asleep: the part of a world that ref/sleep/sleep.c keeps, for those
 * that only look. spec/sleep/sleep.md */
#ifndef REF_REST_H
#define REF_REST_H

#include "ref/world/state.h"

/* The rest of one cloth, part of the state. */
struct rest {
    int32_t steps; /* since its anchor was set, to SLEEP_MOST; 0: it has none */
    int32_t asleep; /* 1: it is */
    int32_t group;  /* the first of the cloths that it fell asleep with */
    int32_t past;   /* the world's `past` when it fell asleep */
    double far; /* m, the farthest of a particle from its anchor since then */
};

/* How the streams hold a cloth that is asleep. */
struct held {
    bool on;    /* its particles have w = 0 */
    bool known; /* energy is that of its state */
    double energy[3];
};

/* Arrays without a note lie on the host. */
struct sleep {
    struct rest *rest; /* [n_cloths] */
    struct rest *was;  /* [n_cloths] when the step began */
    int past;          /* the world's `past` then */
    struct held *held; /* [n_cloths] */
    real *most;        /* scratch: [n_cloths] */
    int32_t *of;       /* scratch: [n_cloths] the island of each cloth */
    uint8_t *flag;     /* scratch: [bodies] */
    int n;             /* cloths asleep */
    int32_t epoch;     /* counts changes of who is held */
    bool woken;        /* something came near a cloth that is asleep */
    uint8_t *mask;     /* backend: [nv] 1: a query must look at it */
    uint8_t *awake;    /* backend: [bodies] the same of bodies */
    uint8_t *active, *disturbed; /* backend: [bodies] as in struct wake */
    int32_t *label;              /* backend: [n_cloths] */
};

/* Whether this cloth is awake. */
static inline bool sleep_awake(const struct world *w, int cloth)
{
    return !w->sleep->rest[cloth].asleep;
}

/* Whether all cloths are asleep. */
static inline bool sleep_all(const struct world *w)
{
    return w->sleep->n == w->def.n_cloths;
}

#endif
