/* SPDX-License-Identifier: Apache-2.0 */
/* Collision response in rounds: its state, the loops of the reference in a
 * round between the stages, and the last rounds, which always end.
 * spec/contact/response.md */
#ifndef REF_ROUNDS_H
#define REF_ROUNDS_H

#include "ref/base/backend.h"
#include "ref/broad/tree.h"
#include "ref/contact/contact.h"

/* Candidates: each pair once; the memory is the broad phase's, valid until
 * its next call. */
struct pairs {
    int64_t n;
    const int32_t *pair; /* [n][4] v f f f or a a b b */
    const uint8_t *kind; /* [n] enum contact_kind */
};

/* All streams and pools lie in the memory of the backend. */
struct response {
    const struct backend *run;
    struct gpu *on; /* the first argument of the backend's functions */

    int64_t nv;
    const real *w; /* [nv] 1/kg, ≥ 0; 0: prescribed, x1 and v stay */
    struct surfaces surfaces;   /* of the vertices */
    struct one_rings one_rings; /* the triangles around each vertex */
    const vec *x0;   /* [nv] m, start of the step; nothing touches there */
    vec *x1, *v;     /* in, out: [nv] m and m/s, end of the step */
    real dt;         /* s, > 0 */
    real stiffness;  /* N/m, ≥ 0, of the push apart in proximity */
    real range;      /* > 0: pairs nearer than so many times their thickness
                        are contacts */
    real margin;     /* of its thickness that an impact shall leave, ≥ 0 */
    real stiffest;   /* kg, ≥ 0: no κ grows beyond; 0: none grows */
    int iterations;  /* of contacts in an early round, ≥ 0 */
    int max_rounds;  /* of impulses, ≥ 0 */
    int zone_rounds; /* ≥ 0, after those */
    int roll_rounds; /* ≥ 0: of growing rollback before all go back */
    bool stop_before_zones; /* end where zones would begin: the step is tried
                               anew */

    /* Every pair that may touch between x0 and x1 and has a vertex i with
     * touched[i] (NULL: every pair). DRAPE_OK or an error. */
    int (*broad)(void *user, const uint8_t *touched, struct pairs *out);
    void *user;
    real reach; /* m, ≥ 0: broad also finds the pairs that may come so near,
                   of a detection in which something may arrive */
    int64_t seams; /* ≥ 0: contacts for which a pool has room behind the active
                      set */
    bool solves;   /* contacts of repulsion take part in an implicit solve
                      (lagrange.md), and stay in the active set */

    struct trace *trace; /* NULL: none */

    vec *u;           /* scratch: [nv] m/s, (x1 - x0) / dt as it changes */
    uint8_t *touched; /* scratch: [nv] */
    uint8_t *rolled;  /* scratch: [nv] */
    int32_t *start;   /* scratch: [nv + 1]; also the zones' labels */
    uint64_t *first;  /* scratch: [nv], of impulses */

    /* Pools, empty at first, kept from step to step. */
    struct pool at, toi, tier, hit, hit_kind, hit_toi;
    struct pool contact[3], item, parts, lack, push, vertex, moved,
        contact_awake;
    struct pool key[2], sum, zone, tangle[2];

    int rounds;         /* out: of penetration, the last finds nothing */
    int64_t contacts;   /* out: pairs in proximity */
    int64_t impacts;    /* out: pairs that touched, all rounds */
    int64_t candidates; /* out: given to the narrow phase, all rounds */
    int64_t close;      /* out: given to proximity */
    int64_t later;      /* out: of candidates, those of later rounds */
    int narrow;         /* out: detections that had a candidate */
    int64_t zone_vertices, rolled_back; /* out: of the last zones; all */
    int64_t started,
        prescribed; /* out: pairs that touch at the start, and pairs
                without a free vertex that touch: left alone */
    int outcome;    /* out: or of enum drape_outcome */

    int64_t hits, arrivals, active, tangled; /* items in the pools */
    int arrived;           /* the pool of arrivals; the active set
                              follows there */
    int side, tangle_side; /* which of the pools */
    int solved;            /* the pool of the contacts that the last
                              solve left, as it left them */
    int64_t n_solved;      /* how many these are; 0: none */
    bool contacts_solved;  /* contacts has solved a round */
    bool done;             /* nothing touches on the way: no round is
                              needed */
};

/* §4: iterations of contacts in the round under way: as many more in each late
 * one, as what is left by then moves little. */
static inline int response_iterations(const struct response *s)
{
    return s->iterations * (s->rounds > 2 ? s->rounds - 1 : 1);
}

/* Counters of a step in which nothing came near. */
static inline void response_reset(struct response *s)
{
    s->rounds = s->outcome = s->side = s->solved = s->tangle_side = 0;
    s->contacts = s->impacts = s->candidates = 0;
    s->close = s->later = s->narrow = 0;
    s->started = s->prescribed = 0;
    s->zone_vertices = s->rolled_back = 0;
    s->hits = s->arrivals = s->active = s->n_solved = s->tangled = 0;
    s->contacts_solved = s->done = false;
}

/* The stiffness of repulsion, of the largest stretch of a cloth. */
#define RESPONSE_SOFT R(0.1)

/* The items that a pool must have room for. */
struct pool_need {
    struct pool *pool;
    int64_t need;
    size_t size; /* bytes of an item */
};

/* Gives the n pools room for these items, until the next solve. DRAPE_OK or
 * DRAPE_ENOMEM. */
static inline int response_grow(const struct response *s, int n,
                                const struct pool_need *pool_need)
{
    int status = DRAPE_OK;
    for (int k = 0; k < n && status == DRAPE_OK; k++)
        if (pool_need[k].need > pool_need[k].pool->cap)
            status = s->run->grow(s->on, pool_need[k].pool, ARENA_RESPONSE,
                                  pool_need[k].need, pool_need[k].size, false);
    return status;
}

/* The rounds of the fail-safe, on either backend: ref/contact/failsafe.c. */

/* §5: the vertices of all hits since impulses ended move in zones. */
int failsafe_zones(struct response *s);

/* §6: the vertices of the hits go back; hits is how many did. */
int failsafe_rollback(struct response *s, int round);

#endif
