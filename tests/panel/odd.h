/* SPDX-License-Identifier: Apache-2.0 */
/* Random odd cells and stars of a panel, with the lists that the stages read.
 */
#ifndef TESTS_ODD_H
#define TESTS_ODD_H

#include "ref/panel/lists.h"
#include "tests/cloth/sheet.h"

/* A grid with odd cells, and its state. */
struct odd {
    struct grid grid;
    struct panel panel;
    vec *x; /* [count] m */
};

/* Cells of any shape, also with the same corner twice, and any forms; in a
 * benchmark one cell of fifty, with the forms of a regular cell. */
struct odd pick_odd(struct bytes *b);

/* What an entry k of a stream that a stage adds to is before. */
real odd_before(int64_t k);

/* The form of fibre f of a cell, of a [count], in binary64. size: the sum of
 * the sizes of its terms. */
void odd_form(const struct fibre *f, const int32_t at[4], const vec *a,
              double d[3], double *size);

/* Gives a stage the grid's laws, and the odd cells. */
#define GIVE_ODD(stage, odd)                                                   \
    do {                                                                       \
        (stage)->count = (odd)->grid.count;                                    \
        (stage)->laws = SPRINGS;                                               \
        (stage)->law = (odd)->grid.law;                                        \
        (stage)->pieces = (odd)->grid.pieces;                                  \
        (stage)->piece = (odd)->grid.piece;                                    \
        (stage)->n_cells = (odd)->panel.n_cells;                               \
        (stage)->corner = (const int32_t(*)[4])(odd)->panel.corner;            \
        (stage)->fibre = (const struct fibre(*)[6])(odd)->panel.fibre;         \
        (stage)->x = (odd)->x;                                                 \
    } while (0)

#endif
