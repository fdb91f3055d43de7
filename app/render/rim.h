/* SPDX-License-Identifier: Apache-2.0 */
/* Rounds the rims of holes in pictures, where the grid makes stairs of them. */
#ifndef APP_RENDER_RIM_H
#define APP_RENDER_RIM_H

#include "app/render/picture.h"

/* The particles of a cloth, [n][m] in the model's vertices. */
struct grid {
    int64_t first;
    int m, n;
};
/* Moves the particles at the rims of a cloth's holes and cuts towards the
 * middle of their two neighbours on the rim, in the picture only; the sheet's
 * own four edges stay. cloth: the model's cloth triangles are its first
 * `triangles`. Returns app_exit; a failure prints one line. */
int rim_round(struct pool *pool, struct model *model, const struct grid *cloth,
              int64_t triangles);

#endif
