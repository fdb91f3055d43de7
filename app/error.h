/* SPDX-License-Identifier: Apache-2.0 */
/* drape run --error: finds the cheapest setting whose error is small enough. */
#ifndef APP_ERROR_H
#define APP_ERROR_H

#include "app/scene.h"

/* The requested error and the error that trial runs measured. */
struct estimate {
    double asked;   /* m, 0: --error was not given */
    double error;   /* m, root mean square over the cloth's positions */
    double horizon; /* s from the start: the error is of this time span */
};

/* Sets the scene's integrator, dt, steps a frame and tolerance. Rows of the
 * table of spec/accuracy.md §9 are tried, the cheapest first, from the row that
 * the page's diagrams give for this error. The measured error is that of time
 * stepping and of the solver alone, over the first frames. APP_OK; APP_FINDINGS
 * after one line where no row is good enough; or as scene_create. */
int error_choose(struct scene *scene, const struct overrides *overrides,
                 double asked, struct estimate *estimate);

#endif
