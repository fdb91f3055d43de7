/* SPDX-License-Identifier: Apache-2.0 */
/* Cusick's drape test of a material. spec/validation.md §6 */
#ifndef VALIDATE_CUSICK_H
#define VALIDATE_CUSICK_H

#include "validate/validate.h"

struct drape {
    int sizes;
    double percent[SIZES]; /* the drape coefficient; NAN: no rest was found */
    double folds[SIZES];
};
/* At each size of cells, the coarsest first; each starts as the one before it
 * lay. */
struct drape cusick(const struct validate *v, const drape_material *material,
                    const double *cell, int sizes);

#endif
