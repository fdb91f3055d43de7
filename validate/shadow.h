/* SPDX-License-Identifier: Apache-2.0 */
/* The shadow of a draped disc, seen along gravity. spec/validation.md §6 */
#ifndef VALIDATE_SHADOW_H
#define VALIDATE_SHADOW_H

#include "validate/validate.h"

struct shadow {
    double area; /* m², of what lies beyond the support and below it */
    int folds;   /* of its outline */
};
/* Of the triangles of a sheet about x = z = 0 without its holes. */
struct shadow shadow_of(const struct sheet *s);

#endif
