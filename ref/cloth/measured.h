/* SPDX-License-Identifier: Apache-2.0 */
/* The laws of springs that give a sheet the tension which was measured in warp,
 * weft and bias. spec/cloth/cloth.md §9 */
#ifndef REF_MEASURED_H
#define REF_MEASURED_H

#include "ref/base/stage.h"

struct cloth;

/* Gives the laws of c, which have been set by §4 already, the pieces of a's
 * tables. DRAPE_OK, or DRAPE_EARG with the reason in c->misfit. */
int measured_laws(const drape_material *a, struct cloth *c);

#endif
