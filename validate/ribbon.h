/* SPDX-License-Identifier: Apache-2.0 */
/* A slender strip that bends and twists by its weight, and the same as a rod.
 * validate/ribbon.c */
#ifndef VALIDATE_RIBBON_H
#define VALIDATE_RIBBON_H

#include "validate/validate.h"

/* Clamped at one end with its axis level; the other end hangs free. */
struct ribbon {
    double gamma; /* w L³ / D */
    double roll; /* of the clamp about the axis: 0 lies flat, π/2 is on edge */
};
/* The length of a ribbon, m. */
double ribbon_length(const struct ribbon *r);
/* By how much the middle of its free end is lower than the clamp, and how far
 * it is to the side, over the length. NAN: no equilibrium was found. */
void ribbon_rod(const struct ribbon *r, double tip[2]);
/* The same of a sheet with so many cells of width. */
void ribbon_sheet(const struct validate *v, const struct ribbon *r, int across,
                  double tip[2]);

#endif
