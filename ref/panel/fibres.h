/* SPDX-License-Identifier: Apache-2.0 */
/* The forms of the fibres of an odd cell. spec/panel/panel.md §2 */
#ifndef REF_FIBRES_H
#define REF_FIBRES_H

#include "ref/panel/lists.h"

/* Returns the area of a cell with 3 or 4 corners at x, m, counter-clockwise. */
double cell_area(const double x[4][2], int corners);

/* Sets the fibres of such a cell, of a grid with cells of hu × hv. */
void make_fibres(const double x[4][2], int corners, double hu, double hv,
                 struct fibre fibre[FIBRES]);

#endif
