/* SPDX-License-Identifier: Apache-2.0 */
/* Pictures of where bodies intersect. */
#ifndef APP_RENDER_MARKS_H
#define APP_RENDER_MARKS_H

#include "app/read/untangle.h"

/* Writes front.png and back.png into the folder: the bodies, what intersects in
 * red, and a ring around each region, through whatever hides it. x: [nv] m,
 * where they were. Returns app_exit. */
int marks_draw(const struct untangling *u, const double (*x)[3],
               const char *directory);

#endif
