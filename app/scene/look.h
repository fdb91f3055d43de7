/* SPDX-License-Identifier: Apache-2.0 */
/* How a body looks in pictures: from a scene to its report, and from there to
 * the pictures. */
#ifndef APP_SCENE_LOOK_H
#define APP_SCENE_LOOK_H

#include "app/read/json.h"

#include <stdbool.h>

/* A body's look; what is below 0 was not given, and is its kind's. */
struct look {
    double colour[3], inside[3]; /* sRGB, 0 … 1; inside: cloth's other side */
    double gloss;                /* 0 … 1 */
    int check;                   /* 1: woven in checks; of cloth */
};

/* The look of a body of which nothing is said. */
struct look look_default(void);
/* Reads a scene's look; out: struct look. */
json_reader read_look;
/* Writes the look as an object: what was given of it, and check. */
void look_write(FILE *out, const struct look *look);
/* Reads what look_write has written; NULL: the default. False if no run could
 * have written it. */
bool look_restore(json_t *node, struct look *look);

#endif
