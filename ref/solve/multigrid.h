/* SPDX-License-Identifier: Apache-2.0 */
/* Stage multigrid: one V-cycle, a symmetric positive definite approximation
 * of the inverse. spec/solve/multigrid.md */
#ifndef REF_MULTIGRID_H
#define REF_MULTIGRID_H

#include "ref/base/stage.h"

struct packed;
struct packed_parts;

enum { LEVELS = 40 };

struct multigrid {
    int32_t m, n;     /* particles along i and j */
    int64_t count;    /* m·n */
    const real *mass; /* [count] kg */
    int64_t n_extra;  /* count, or 0: none */
    const sym *extra; /* [n_extra] kg */
    int64_t n_blocks; /* SPRINGS·count */
    const sym *block; /* [n_blocks] kg, 0 where missing */
    int64_t n_packed; /* SPRINGS·count, or 0: none, smooth with block */
    const struct packed
        *packed;          /* [n_packed] kg, in place of block for smoothing */
    int32_t triples;      /* 1: blocks of triples, A ≤ 3·diagonal; 0: of
                             springs alone, A ≤ 2·diagonal */
    const uint8_t *fixed; /* [count] */
    const sym *factor;    /* [count] of ref_jacobi, with packed if there is
                             any */
    const vec *r;         /* [count] 0 where fixed */
    int32_t depth;        /* the last grid; 0: the first of at most 16 particles
                           */

    int64_t n_pool, n_room, n_live, n_dense; /* from ref_multigrid_size */
    int64_t n_parts;                         /* from ref_multigrid_size */
    struct packed_parts *parts; /* scratch: [n_parts] packed, decoded once; the
                                 device decodes packed at each read */
    sym *pool;                  /* scratch: [n_pool] coarse operators */
    vec *room;                  /* scratch: [n_room] vectors of all grids */
    uint8_t *live;              /* scratch: [n_live] live springs, then rules */
    double *dense;              /* scratch: [n_dense] factor of the coarsest
                                   grid */

    vec *z; /* out: [count] M⁻¹ r, 0 where fixed */
};

/* Sets the sizes from m, n and n_packed. Returns the bytes of scratch, 0 if m
 * or n is below 1. */
int64_t ref_multigrid_size(struct multigrid *s);

/* Builds the coarse operators. DRAPE_OK, or DRAPE_EARG as ref_coarsen. */
int ref_multigrid_build(struct multigrid *s);

/* Runs one V-cycle with the operators that ref_multigrid_build has made. */
void ref_multigrid_cycle(struct multigrid *s);

/* Builds the operators, then runs one V-cycle. Returns as the build does. */
int ref_multigrid(struct multigrid *s);

#endif
