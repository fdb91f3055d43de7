/* SPDX-License-Identifier: Apache-2.0 */
/* Stage multigrid: one V-cycle, a symmetric positive definite approximation
 * of the inverse. spec/solve/multigrid.md */
#ifndef REF_MULTIGRID_H
#define REF_MULTIGRID_H

#include "ref/solve/coarsen.h"

enum { LEVELS = 40 };

struct multigrid {
    int32_t m, n;            /* particles along i and j */
    int64_t count;           /* m·n */
    const real *mass;        /* [count] kg */
    int64_t n_extra;         /* count, or 0: none */
    const sym *extra;        /* [n_extra] kg */
    int64_t n_blocks;        /* SPRINGS·count */
    const sym *block;        /* [n_blocks] kg, 0 where missing */
    int64_t n_thin;          /* SPRINGS·count, or 0: the blocks are read */
    const struct thin *thin; /* [n_thin] kg, smoothed with in their place */
    const uint8_t *fixed;    /* [count] */
    const sym *factor;       /* [count] from ref_jacobi, of the same */
    const vec *r;            /* [count] 0 where fixed */

    int64_t n_pool, n_room, n_live, n_dense; /* from ref_multigrid_size */
    int64_t n_parts;                         /* likewise */
    struct thin_parts *parts; /* scratch: [n_parts] thin, opened once; the
                                 device opens them where they are read */
    sym *pool;                /* scratch: [n_pool] coarse operators */
    vec *room;                /* scratch: [n_room] */
    uint8_t *live;            /* scratch: [n_live] */
    double *dense;            /* scratch: [n_dense] coarsest factor */

    vec *z; /* out: [count] M⁻¹ r, 0 where fixed */
};

/* Sets the sizes from m, n and n_thin. Returns the bytes of scratch, 0 if the
 * grid makes no sense. */
int64_t ref_multigrid_size(struct multigrid *s);

/* Builds the coarse operators. DRAPE_OK, or DRAPE_EARG as ref_coarsen. */
int ref_multigrid_build(struct multigrid *s);

/* One V-cycle on what was built. */
void ref_multigrid_cycle(struct multigrid *s);

/* Both. */
int ref_multigrid(struct multigrid *s);

#endif
