/* SPDX-License-Identifier: Apache-2.0 */
/* Stage pcg: the system of one cloth, solved by preconditioned conjugate
 * gradients. spec/solve/pcg.md */
#ifndef REF_PCG_H
#define REF_PCG_H

#include "ref/solve/multigrid.h"

enum pcg_outcome {
    PCG_CONVERGED, /* the true residual is within the tolerance */
    PCG_LIMIT,     /* max_iterations are used up */
    PCG_STALLED,   /* rounding keeps the true residual above the tolerance */
    PCG_BREAKDOWN  /* not a number, or the matrix is not positive definite */
};

struct mat;
struct product;

struct pcg {
    int32_t m, n;           /* particles along i and j, ≥ 1 */
    int64_t count;          /* m·n */
    int32_t precond;        /* enum drape_precond */
    int32_t form;           /* enum drape_matrix */
    int32_t depth;          /* of multigrid.h */
    real tolerance;         /* of the relative residual, ≥ 0 */
    int32_t max_iterations; /* ≥ 0 */
    int32_t solver;         /* enum drape_solver, for the device */
    int32_t energy; /* 1: tolerance is of √(r·M⁻¹r) instead, §4.1 */
    real scale;  /* ≥ 0, with energy: r·M⁻¹r is measured relative to this
                    or to its first value, whichever is larger; out: the
                    larger one */
    real square; /* ≥ 0, with energy: the same for r·r */
    const real *mass; /* [count] kg, > 0 where free */
    int64_t n_extra;  /* count, or 0: none */
    const sym *extra; /* [n_extra] kg, positive semidefinite */
    int64_t n_blocks; /* SPRINGS·count */
    const sym *block; /* [n_blocks] kg, spring o of p at o·count + p, 0
                         where missing; their sum is positive
                         semidefinite */
    int64_t n_packed; /* SPRINGS·count, or 0: the blocks themselves */
    const struct packed *packed; /* [n_packed] kg, from ref_blocks, of which
                                multigrid is made */
    int32_t triples;             /* 1: the blocks are of triples, too */
    int32_t whole; /* 1: there are no packed blocks, as those of a panel are
                      sums that have no such code (joins.md §2) */
    const uint8_t *fixed; /* [count] not 0: dv is given */
    const vec *b;         /* [count] N·s */
    int64_t n_z;          /* count, or 0: given dv are 0 */
    const vec *z;         /* [n_z] m/s, read where fixed */

    int64_t n_cdf, n_chunks; /* from ref_pcg_size */
    struct mat *cdf;         /* scratch: [n_cdf] */
    sym *diagonal;           /* scratch: [count], of the cdf alone */
    sym *factor;             /* scratch: [count] */
    vec *low;                /* scratch: [count] m/s, rounding errors of dv */
    vec *r, *s, *p, *q;      /* scratch: [count] */
    real *chunk;             /* scratch: [n_chunks] */
    struct multigrid grid;   /* scratch: its pool, room, live and dense, of
                                its sizes, 0 but where precond is multigrid */

    vec *dv;            /* out: [count] m/s */
    int32_t iterations; /* out: products with a search direction */
    int32_t outcome;    /* out: enum pcg_outcome */
    int32_t fell_back;  /* out: 1: multigrid broke down, Jacobi went on */
    real recurrence;    /* out: relative residual, by the recurrence */
    real residual;      /* out: |b - A (dv + low)| / √square, where free;
                           without energy, / |b - A z| */
};

/* Sets count, n_blocks and the sizes of the scratch from m, n, precond and
 * form. Returns the bytes of scratch. */
int64_t ref_pcg_size(struct pcg *s);

/* Checks s, clears its results, and gives its grid the streams that both share.
 * DRAPE_OK, or DRAPE_EARG if sizes, precond or form make no sense. */
int pcg_open(struct pcg *s);

struct matrix;
struct jacobi;

/* The stages that prepare a solve, on one backend. */
struct pcg_stages {
    int (*matrix)(void *backend, struct matrix *s);
    int (*jacobi)(void *backend, struct jacobi *s);
    int (*multigrid)(void *backend, struct multigrid *s);
};
/* §1: makes the matrix and M by these stages, after pcg_open. Returns the
 * status of the stages. */
int pcg_set_up(struct pcg *s, const struct pcg_stages *stages, void *backend);

/* The same by the reference's stages. */
int ref_pcg_set_up(struct pcg *s);

/* The product y = A x with the matrix of a solve. */
struct product pcg_product(const struct pcg *s, const vec *x, vec *y);

/* Sets s to M⁻¹ r, by Jacobi where multigrid has broken down. */
void pcg_precondition(struct pcg *s);

/* §2: sets r to the true residual b - A (dv + low), 0 where fixed. */
void residual_find(const struct pcg *s);

/* Whether a, a curvature or a squared norm, is finite and above 0. */
static inline bool pcg_positive(real a)
{
    return a > 0 && a - a == 0;
}

/* DRAPE_OK however the iteration ends; DRAPE_EARG as pcg_open. */
int ref_pcg(struct pcg *s);

#endif
