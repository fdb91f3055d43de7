/* SPDX-License-Identifier: Apache-2.0 */
/* The seams of a world on the grids of multigrid, and the cycle of all cloths
 * that they join. spec/solve/sewn.md */
#ifndef REF_SEWN_H
#define REF_SEWN_H

#include "ref/solve/multigrid.h"

/* A row of a link, or a link of a row, and the row's weight in it. */
struct sewn_term {
    int32_t at;
    real c;
};

/* What a point or a hinge of a seam is on one grid: its terms are its rows. */
struct sewn_link {
    int32_t source;     /* which contact of the seams has its κ */
    real times;         /* for how many it stands */
    int32_t first, end; /* its terms */
};

/* A particle that links hold: its terms are these, ascending. */
struct sewn_row {
    int32_t cloth, particle;
    int32_t first, end;
};

/* Unknowns of cloths that are sewn together, on the last grid. */
struct sewn_group {
    int32_t n, first; /* unknowns, and their first */
    int32_t cloth;    /* one of its cloths */
    int64_t dense;    /* where the n rows of the inverse begin */
};

/* Where a cloth's unknowns are: from `first` on, of its group. */
struct sewn_place {
    int32_t group, first;
};

/* Links of grid k are those at link_at[k] … link_at[k + 1] - 1, and rows
 * likewise; first and end of both count in of_link and of_row, whatever the
 * grid. The lists and scratch lie in the memory of the backend. */
struct sewn {
    int32_t depth; /* the last grid of each cloth, at least 1 */
    int64_t links, rows, terms;
    int64_t link_at[LEVELS + 1], row_at[LEVELS + 1];
    const struct sewn_link *link;    /* [links] */
    const struct sewn_row *row;      /* [rows] */
    const struct sewn_term *of_link; /* [terms] rows */
    const struct sewn_term *of_row;  /* [terms] links */
    int32_t cloths, groups;
    const struct sewn_place *place; /* [cloths] */
    const struct sewn_group *group; /* [groups] */

    int64_t n, most, unknowns, n_dense; /* contacts of the seams; rows of a
                                           grid, at most; of all groups */
    sym *kappa;                         /* scratch: [n] kg */
    vec *answer;               /* scratch: [most] N·s, the reference's */
    double *dense;             /* scratch: [n_dense] inverses */
    double *in, *out;          /* scratch: [unknowns] */
    struct sewn_cloth *cloth;  /* scratch: [cloths] of the reference, or
                                  [depth + 1][cloths] of the device, */
    struct sewn_cloth *listed; /* and the same on the host */
};

/* Which grid of each cloth is the last. 0: this world has no such grids. */
int32_t sewn_depth(const drape_def *def);

/* Bytes of the reference's struct sewn_cloth. */
size_t ref_sewn_bytes(void);
/* Before the two functions that follow: cloth k, with its r and z. What is not
 * awake takes no part. */
void ref_sewn_put(struct sewn *s, int k, const struct multigrid *grid,
                  bool awake);
/* After the cloths' own preconditioners and kappa: adds the links to the
 * factors, and inverts the last grids. */
void ref_sewn_set_up(struct sewn *s);
/* z = M⁻¹ r of all cloths. */
void ref_sewn_cycle(struct sewn *s);

#endif
