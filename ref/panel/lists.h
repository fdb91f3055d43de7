/* SPDX-License-Identifier: Apache-2.0 */
/* What a panel has beside the grid of a rectangle: fibres of odd cells, stars
 * at the border, and the lists by which particles and blocks gather them.
 * spec/panel/panel.md */
#ifndef REF_LISTS_H
#define REF_LISTS_H

#include "ref/cloth/cloth.h"

/* Fibres, pairs and corners of an odd cell. §2, §3 */
enum { FIBRES = 6, CELL_PAIRS = 6, CORNERS = 4 };
/* The direction of the law of each fibre. */
static const int8_t fibre_law[FIBRES] = {0, 0, 1, 1, 2, 3};
/* The corners that each pair of a cell joins. */
static const int8_t pair_ends[CELL_PAIRS][2] = {{0, 1}, {1, 2}, {2, 3},
                                                {3, 0}, {0, 2}, {1, 3}};

/* A fibre's form d = Σ c (x - x_0) over the corners 1, 2, 3 of its cell. */
struct fibre {
    real c[3];
    real weight; /* of its law, ≥ 0; 0: the cell has no such fibre */
};

/* A star's form t = Σ c (x - x_0), its energy ½ k |t|². */
struct star {
    int32_t at[5]; /* the middle, then the arms; a missing one is the middle */
    real c[4];     /* of the arms */
    real k;        /* N/m, ≥ 0 */
};

struct panel {
    int64_t n_cells;          /* odd cells, ascending */
    int32_t (*corner)[4];     /* [n_cells] particles, counter-clockwise; of a
                                 triangle the last is the first again */
    struct fibre (*fibre)[6]; /* [n_cells] */
    int64_t n_pairs;          /* ascending by first, then way */
    int32_t *first;           /* [n_pairs] particle */
    uint8_t *way;             /* [n_pairs] forward direction of the other */
    real *bend;               /* [n_pairs] N/m, Σ ½ bend |x_q - x_p|² is the
                                 energy of the stars */
    int32_t (*from)[2];       /* [n_pairs] CELL_PAIRS·cell + pair of the odd
                                 cells that have it, ascending; -1: none */
    int64_t n_parts;          /* particles of pairs, ascending */
    int32_t *part;            /* [n_parts] */
    int32_t (*push)[4];       /* [n_parts] CORNERS·cell + corner of the odd
                                 cells that have it, ascending; -1: none */
    int32_t (*tie)[16];       /* [n_parts] its pair in direction o at 2·o, that
                                 against o behind it; -1: stars join none */
    int64_t n_stars;          /* ascending by middle, then direction */
    struct star *star;        /* [n_stars] */

    /* What mass and bending are made of, on the host. */
    double *area;      /* [n_parts] m², of a particle that has odd cells; 0 */
    double *share;     /* [n_stars] m², the area that a star answers for */
    uint8_t *star_way; /* [n_stars] its direction */
    double *sum;       /* scratch: [n_pairs] N/m */

    vec *pushes; /* scratch: [CORNERS·n_cells] N */
    sym *joins;  /* scratch: [CELL_PAIRS·n_cells] kg */
    real *chunk; /* scratch: [sum_chunks(n_cells + n_stars)] */
};

#endif
