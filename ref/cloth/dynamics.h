/* SPDX-License-Identifier: Apache-2.0 */
/* One cloth's motion over a step as if nothing were in its way.
 * spec/cloth/dynamics.md */
#ifndef REF_DYNAMICS_H
#define REF_DYNAMICS_H

#include "ref/base/thin.h"
#include "ref/base/trace.h"
#include "ref/cloth/cloth.h"

struct dynamics {
    const struct cloth *cloth;
    int method;       /* enum drape_integrator */
    double dt;        /* s, > 0 */
    int max_substeps; /* of explicit methods, ≥ 1 */
    vec gravity;      /* m/s² */
    int windy;        /* 0: no air, and no wind stage */
    vec air;          /* m/s */
    real drag, lift;  /* kg/m³, half the air's density × coefficient */

    const vec *x, *v;   /* [count] m, m/s, start of the step */
    int has_past;       /* 1: xp and vp hold the step before (Choi–Ko) */
    const vec *xp, *vp; /* [count] or NULL */
    const vec *to;      /* [count] m, where pinned particles end */
    const vec *press;   /* [count] N, of contacts (warm.md), or NULL */

    /* Solves (mass + Σ blocks) dv = b with dv = 0 where fixed; reads cloth,
     * block and b, writes dv, iterations and residual, and ors
     * DRAPE_UNCONVERGED into outcome. DRAPE_OK or negative. NULL for
     * explicit methods. */
    int (*solve)(struct dynamics *s);
    void *solver; /* solve's own */

    vec *work;  /* scratch: [dynamics_vecs()·count] */
    sym *block; /* scratch: [SPRINGS·count] of an implicit method, or NULL */
    struct thin *thin; /* scratch: likewise, of one with multigrid, or NULL */
    real *chunk;       /* scratch: [3·sum_chunks(count)] */

    struct trace *trace; /* NULL: none */

    vec *b, *dv; /* set for solve: [count], within work */

    double reference, surplus; /* in, out: J, §3; 0 at first */
    vec *x1, *v1;              /* out: [count], not x or v */
    int32_t substeps;          /* out: made, or needed (DRAPE_ELIMIT) */
    int iterations;            /* out: of the solver */
    double residual;           /* out: relative, of the solver */
    int outcome;               /* out: or of enum drape_outcome */
    double before[3];          /* out: kinetic, elastic, of gravity, J, at x */
    double energy[3];          /* out: likewise at x1 */
};

static inline bool dynamics_implicit(int method)
{
    return method == DRAPE_BW || method == DRAPE_CK;
}

/* Streams of vec in work. */
static inline int64_t dynamics_vecs(int method, int windy)
{
    int64_t own = method == DRAPE_BW ? 4 : method == DRAPE_CK ? 6 : 5;
    return own + (windy ? 3 : 0);
}

/* DRAPE_OK; DRAPE_ELIMIT if max_substeps are not stable; or what solve
 * returned. An outcome with DRAPE_DIVERGED leaves x1 = x and v1 = v. */
int ref_dynamics(struct dynamics *s);

/* Kinetic, elastic and gravitational energy of a state, J; uses chunk. */
void dynamics_energy(const struct dynamics *s, const vec *x, const vec *v,
                     double value[3]);

#endif
