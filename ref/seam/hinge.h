/* SPDX-License-Identifier: Apache-2.0 */
/* Bending across a seam. spec/seam/seam.md §6 */
#ifndef REF_HINGE_H
#define REF_HINGE_H

#include "ref/base/stage.h"

/* A second difference across the seam at a point, Σ c x = ½ d² κ of a sheet
 * with the curvature κ. */
struct hinge {
    int32_t at[4]; /* particles: the one behind the point's, the point's, and
                      two behind its place; the first two of cloth[0] */
    double c[4];   /* they add to 0; c[1] = -1 */
    double shape;  /* 1/m², its stiffness over the moment `bend` */
    double behind; /* m, mean distance from the seam to the rows behind it */
};

/* Finds the hinge of a point of a seam. False if there is none. */
bool hinge_find(const drape_def *def, const drape_seam *seam, int64_t point,
                struct hinge *hinge);
/* §6: the moment across a seam of these cloths for curvature 1, N·m. */
double hinge_bend(const drape_material *a, const drape_material *b);
/* Marks the particles of cloth k at which a hinge bends: marks [its
 * particles]. */
void hinge_mark(const drape_def *def, int k, uint8_t *marks);

#endif
