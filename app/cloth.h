/* SPDX-License-Identifier: Apache-2.0 */
/* A cloth on its way from a scene's text to the library. */
#ifndef APP_CLOTH_H
#define APP_CLOTH_H

#include "app/json.h"
#include "app/shapes.h"

#include <drape.h>

/* A disc x, y, r or a rectangle x0, y0, x1, y1 at rest; r < 0: none. */
struct region {
    double disc[3], rect[4];
};
struct regions {
    struct region *list;
    int count;
};
struct pin {
    int edge, motion;    /* edge: 0 … 3, -1: none */
    double at[2], every; /* m at rest */
};
struct cloth {
    drape_cloth out;
    char *name;
    double particles[2], size[2], velocity[3];
    struct start start;
    struct regions holes, cuts;
    struct pin *pins;
    int n_pins;
    int *pin_from; /* [out.n_pins]: the one of pins that it is of */
};

/* Fills cloth->out's start, holes, cuts and pins. The exit code after one
 * line where they make no sense. */
int cloth_sew(struct json *json, struct cloth *cloth);

#endif
