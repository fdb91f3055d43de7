/* SPDX-License-Identifier: Apache-2.0 */
/* Pictures of a frame by ray tracing: a soft sun, a sky, one bounce. */
#ifndef APP_RENDER_PICTURE_H
#define APP_RENDER_PICTURE_H

#include "app/scene/scene.h"

/* How triangles of one body look. */
struct surface {
    float side[2][3]; /* colour of the outside and of the inside, linear */
    float gloss, sheen;
    bool check; /* woven in checks */
};

/* The geometry of a picture, in binary32. */
struct model {
    int64_t nv, nt;
    float (*x)[3], (*normal)[3]; /* [nv] m; unit, smooth */
    float (*uv)[2];              /* [nv] m on the cloth at rest */
    uint32_t (*tri)[3];          /* [nt] */
    uint16_t *paint;             /* [nt] index into surface */
    const struct surface *surface;
    float floor;         /* y of an endless floor; NaN: none */
    double lo[3], hi[3]; /* box around all but the floor */
};

struct shot {
    int width, height, samples;
    int threads;          /* 0: as many as there are cores */
    struct camera camera; /* eye at the target: it sees the model's box */
    double turned;        /* degrees that the camera is turned, to the right */
};

/* Fills rgb [height][width][3]; the bytes do not depend on the number of
 * threads. Returns app_exit; a failure prints one line. */
int picture_take(const struct model *model, const struct shot *shot,
                 uint8_t *rgb);
/* Writes rgb as directory/name. false after one line. */
bool picture_save(const char *directory, const char *name, const uint8_t *rgb,
                  int width, int height);

#endif
