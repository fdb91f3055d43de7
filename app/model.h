/* SPDX-License-Identifier: Apache-2.0 */
/* A run's frames as models to take pictures of. */
#ifndef APP_MODEL_H
#define APP_MODEL_H

#include "app/picture.h"

/* What report.json says of a run; without one, defaults. */
struct run_look {
    struct look_cloth {
        int64_t first; /* vertex */
        int m, n;
        double width, height;
    } * cloths; /* [count], in the order of their vertices */
    int count;
    struct camera camera;
    double rate; /* frames a second */
};
int look_load(struct pool *pool, const char *directory, struct run_look *look);

/* Frame k of the run. app_exit after one line. */
int model_load(struct pool *pool, const char *directory, int k,
               const struct run_look *look, struct model *model);

#endif
