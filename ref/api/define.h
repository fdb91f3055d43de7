/* SPDX-License-Identifier: Apache-2.0 */
/* The complete check of a definition. */
#ifndef REF_DEFINE_H
#define REF_DEFINE_H

#include <stdbool.h>

#include "spec/drape.h"

/* DRAPE_OK, or the status; *error: one line that names the fault and its place.
 */
int define_check(const drape_def *def, drape_error *error);
/* Checks wind alone: DRAPE_OK, DRAPE_EARG or DRAPE_EDATA. */
int define_check_wind(const drape_wind *wind);
/* Check one part alone: DRAPE_OK, DRAPE_EARG or DRAPE_EDATA. A motion has its
 * keys, which must not be NULL. */
int define_check_material(const drape_material *material);
int define_check_vectors(int64_t n, const double (*x)[3]);
int define_check_motion(const drape_motion *motion);
/* Whether an allocator has both its functions, or neither. */
bool define_check_allocator(const drape_allocator *allocator);

#endif
