/* SPDX-License-Identifier: Apache-2.0 */
/* drape run --error: the cheapest setting whose error is small enough. */
#ifndef APP_ERROR_H
#define APP_ERROR_H

#include "app/scene.h"

/* What was asked for and what trial runs came to. */
struct estimate {
    double asked;   /* m, 0: nothing was asked */
    double error;   /* m, root mean square of the cloth's positions */
    double horizon; /* s from the start, for which it holds */
};

/* Sets the scene's integrator, dt, steps a frame and tolerance. Rows of the
 * table of spec/accuracy.md §9 are tried, the cheapest first, from the first
 * that its diagrams give for this error. The error is that of time and of the
 * solver alone, over the first frames. APP_OK; APP_FINDINGS after one line
 * where no row is good enough; or as scene_create. */
int error_choose(struct scene *scene, const struct overrides *overrides,
                 double asked, struct estimate *estimate);

#endif
