/* SPDX-License-Identifier: Apache-2.0 */
/* Stage excess: the operator of the finest grid in difference form. Stage
 * coarsen: the Galerkin operator on the next coarser grid.
 * spec/solve/multigrid.md §1 and §2 */
#ifndef REF_COARSEN_H
#define REF_COARSEN_H

#include "ref/solve/matrix.h"

/* A coarse operator couples particles up to two steps apart: 12 forward
 * directions. STENCIL_UP: the direction (0, 1). */
enum { STENCIL = 12, STENCIL_UP = 4 };
static const int8_t stencil_di[STENCIL] = {1, 2,  -2, -1, 0, 1,
                                           2, -2, -1, 0,  1, 2};
static const int8_t stencil_dj[STENCIL] = {0, 0, 1, 1, 1, 1, 1, 2, 2, 2, 2, 2};

struct coarsen {
    int32_t m, n;         /* of the finer grid */
    int64_t count;        /* m·n */
    const sym *excess;    /* [count] kg, E of §1 */
    int64_t n_blocks;     /* SPRINGS·count, or STENCIL·count */
    const sym *block;     /* [n_blocks] kg, direction o of p at o·count + p */
    int64_t n_live;       /* count on the finest grid, else 0 */
    const uint8_t *live;  /* [n_live] bit o: both ends of o are free */
    const uint8_t *rule;  /* [count] of interpolation, §2 */
    int64_t n_coarse;     /* coarse_size(m)·coarse_size(n) */
    int64_t n_out;        /* STENCIL·n_coarse */
    sym *coarse_excess;   /* out: [n_coarse] kg */
    sym *coarse_block;    /* out: [n_out] kg, o of p at o·n_coarse + p */
    sym *factor;          /* out: [n_coarse] diagonal blocks, factored */
    uint8_t *coarse_rule; /* out: [n_coarse] of interpolation, §2 */
};

/* Coarse particle i lies on fine particle 2i; the last may lie outside. */
static inline int32_t coarse_size(int32_t m)
{
    return m / 2 + 1;
}

/* §2: bits of a rule. A fine particle between two coarse ones interpolates half
 * of each. A bit says that the particle is coupled to one side only and takes
 * all from there. */
enum { ONLY_LEFT = 1, ONLY_RIGHT = 2, ONLY_DOWN = 4, ONLY_UP = 8 };

/* Returns twice the weight, along one axis, of the coarse particle that lies d
 * fine steps before the fine particle. */
static inline int axis_weight(int d, bool only_before, bool only_after)
{
    if (d == 0)
        return 2;
    bool before = d == 1, none = before ? only_after : only_before;
    if ((d != 1 && d != -1) || none)
        return 0;
    return (before ? only_before : only_after) ? 2 : 1;
}

/* Returns four times the weight, in a fine particle, of the coarse particle
 * that lies (di, dj) fine steps before it. */
static inline int weight_of(uint8_t rule, int di, int dj)
{
    return axis_weight(di, rule & ONLY_LEFT, rule & ONLY_RIGHT) *
           axis_weight(dj, rule & ONLY_DOWN, rule & ONLY_UP);
}

/* §1: the excess and the live springs of the finest grid. */
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
    uint8_t *rule;        /* out: [count] of interpolation, §2 */
};

/* Both return DRAPE_OK, or DRAPE_EARG if the counts are inconsistent. */
int ref_excess(struct excess *s);
int ref_coarsen(struct coarsen *s);

#endif
