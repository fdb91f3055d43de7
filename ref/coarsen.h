/* SPDX-License-Identifier: Apache-2.0 */
/* Stage coarsen: the Galerkin operator on the next coarser grid.
 * spec/14_multigrid.md §2 */
#ifndef REF_COARSEN_H
#define REF_COARSEN_H

#include "ref/matrix.h"

/* A coarse operator couples all within two steps: 12 forward directions. */
enum { STENCIL = 12 };
static const int8_t stencil_di[STENCIL] = {1, 2,  -2, -1, 0, 1,
                                           2, -2, -1, 0,  1, 2};
static const int8_t stencil_dj[STENCIL] = {0, 0, 1, 1, 1, 1, 1, 2, 2, 2, 2, 2};

struct coarsen {
    int32_t m, n;        /* the finer grid */
    int64_t count;       /* m·n */
    const sym *excess;   /* [count] kg, what couples to nothing */
    int64_t n_blocks;    /* SPRINGS·count, or STENCIL·count */
    const sym *block;    /* [n_blocks] kg, direction o of p at o·count + p */
    int64_t n_live;      /* count where n_blocks is SPRINGS·count, else 0 */
    const uint8_t *live; /* [n_live] bit o: both ends of o are free */
    int64_t n_coarse;    /* coarse_size(m)·coarse_size(n) */
    int64_t n_out;       /* STENCIL·n_coarse */
    sym *coarse_excess;  /* out: [n_coarse] kg */
    sym *coarse_block;   /* out: [n_out] kg, o of p at o·n_coarse + p */
    sym *factor;         /* out: [n_coarse] of the diagonal blocks */
};

/* Coarse particle i lies on fine particle 2i; the last may lie outside. */
static inline int32_t coarse_size(int32_t m)
{
    return m / 2 + 1;
}

/* §1: the excess and the live springs of the finest level. */
struct excess {
    int32_t m, n;         /* particles along i and j */
    int64_t count;        /* m·n */
    const real *mass;     /* [count] kg */
    int64_t n_extra;      /* count, or 0: none */
    const sym *extra;     /* [n_extra] kg */
    int64_t n_blocks;     /* SPRINGS·count */
    const sym *block;     /* [n_blocks] kg */
    const uint8_t *fixed; /* [count] */
    sym *excess;          /* out: [count] kg, 0 where fixed */
    uint8_t *live;        /* out: [count] bit o: both ends of o are free */
};

/* Both: DRAPE_OK, or DRAPE_EARG if the counts do not belong together. */
int ref_excess(struct excess *s);
int ref_coarsen(struct coarsen *s);

#endif
