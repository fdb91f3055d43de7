/* SPDX-License-Identifier: Apache-2.0 */
/* A limb: a capsule that bends in its middle as it is told, made in code. */
#ifndef APP_SCENE_LIMB_H
#define APP_SCENE_LIMB_H

#include "app/read/json.h"
#include "app/scene/shapes.h"
#include "spec/drape.h"

/* The keys of a limb: how far it is bent, degrees, at some times, s. */
struct limb {
    struct limb_key {
        double time, angle;
    } * keys; /* [n_keys], times ascend */
    int n_keys;
};

/* Reads the key `bend` of an obstacle; out: struct limb. */
json_reader read_limb;
/* Makes the frames of a mesh, which is that of the straight limb, and sets it
 * to the first one. Sets what `out` has of frames, placed. APP_OK, or the exit
 * code after one line. */
int limb_bend(struct json *json, const struct limb *limb,
              const struct shape *shape, const struct placement *placement,
              struct mesh *mesh, drape_obstacle *out);

#endif
