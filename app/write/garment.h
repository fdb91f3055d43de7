/* SPDX-License-Identifier: Apache-2.0 */
/* Writes the panels of a sewing pattern as they were cut. */
#ifndef APP_WRITE_GARMENT_H
#define APP_WRITE_GARMENT_H

#include "app/scene/garment.h"

#include <stdio.h>

/* Makes the folder and writes: panels.csv, edges.csv, seams.csv,
 * points.csv and pattern.svg; each panel flat at rest as NUMBER_NAME.ply, in m;
 * and all of them as placed.ply, where the pattern places them. Returns
 * app_exit. After a failure, which prints one line, no file of this call is
 * left. */
int garment_save(const struct garment *garment, const char *directory);

/* Writes the picture: the cells that were cut, the outlines as drawn, the
 * seams in colours and with their numbers. */
void garment_draw(const struct garment *garment, FILE *out);
/* How far the cells' area is from that of the outline, as a part of it. */
double garment_area_error(const struct garment_panel *panel);

#endif
