/* SPDX-License-Identifier: Apache-2.0 */
/* Loads a run's frames as models for pictures. */
#ifndef APP_RENDER_MODEL_H
#define APP_RENDER_MODEL_H

#include "app/render/picture.h"

/* The look of a run from its report.json, or defaults without a report. */
struct run_look {
    struct look_cloth {
        int64_t first; /* vertex */
        int m, n;
        double width, height;
        struct look look;
    } * cloths; /* [count], in the order of their vertices */
    int count;
    struct look_obstacle {
        int64_t first; /* triangle of the scene */
        struct look look;
    } * obstacles; /* [n_obstacles], in the order of their triangles */
    int n_obstacles;
    struct camera camera;
    double rate; /* frames a second */
};
int look_load(struct pool *pool, const char *directory, struct run_look *look);

/* Loads frame k of the run. Returns app_exit; a failure prints one line. */
int model_load(struct pool *pool, const char *directory, int k,
               const struct run_look *look, struct model *model);

#endif
