/* SPDX-License-Identifier: Apache-2.0 */
/* drape run --error: finds the cheapest setting whose error is small enough. */
#ifndef APP_SCENE_ERROR_H
#define APP_SCENE_ERROR_H

#include "app/scene/scene.h"

/* The requested error and the error that trial runs measured. */
struct estimate {
    double asked; /* m, 0: --error was not given */
    double error; /* m, root mean square over the cloth's positions */
    double
        horizon; /* s from the start: the error is at most this for so long */
};

/* Sets the scene's integrator, dt, steps a frame and tolerance. The settings of
 * app/tool/error.c are tried, from the cheapest one that is meant for this
 * error on (spec/accuracy.md §9), for the whole of the run. The measured error
 * is that of time stepping and of the solver alone. Where no setting holds to
 * the end, the horizon is shorter than the run. APP_OK; APP_FINDINGS after one
 * line if no setting is good enough for the first frames; or what scene_create
 * returns.
 */
int error_choose(struct scene *scene, const struct overrides *overrides,
                 double asked, struct estimate *estimate);

#endif
