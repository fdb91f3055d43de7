/* SPDX-License-Identifier: Apache-2.0 */
/* Draws a small world from choices. All its parts are valid. */
#ifndef FUZZ_SMALL_H
#define FUZZ_SMALL_H

#include "fuzz/draw.h"

enum {
    SMALL_SIDE = 9,
    SMALL_PINS = 4,
    SMALL_KEYS = 3,
    SMALL_CLOTHS = 5, /* that are drawn for a world in its whole life */
    SMALL_OBSTACLES = 5
};

struct small {
    drape_def def;
    drape_cloth cloth[SMALL_CLOTHS];
    drape_obstacle obstacle[SMALL_OBSTACLES], kind[3];
    int drawn; /* cloths so far: each starts higher than those before */
    drape_motion motion;
    double time[SMALL_KEYS], position[SMALL_KEYS][3], rotation[SMALL_KEYS][4];
    drape_pin pin[SMALL_CLOTHS][SMALL_PINS];
    double velocity[SMALL_CLOTHS][SMALL_SIDE * SMALL_SIDE][3];
    uint8_t hole[SMALL_SIDE * SMALL_SIDE], cut[SMALL_SIDE * SMALL_SIDE];
    double box_x[8][3], ground_x[4][3], frame[2][4][3];
    drape_seam seam;
    int32_t sewn[SMALL_SIDE], onto[SMALL_SIDE][2];
    double part[SMALL_SIDE];
    bool prescribed; /* set by callers that move pins or obstacles: what the
                 definition holds at rest may move */
    struct bank host, device;
};

/* Draws a world. s must not move in memory while a world of it exists. A stream
 * of zeros gives one cloth of 3 × 3 in the air. */
void small_make(struct small *s, struct bytes *b);
/* Draws the next cloth to *c; s keeps its arrays. */
void small_cloth(struct small *s, struct bytes *b, drape_cloth *c);

/* Checks a state. Returns NULL or the fault: a number that is not finite, or a
 * held particle or an obstacle at rest that has moved. */
const char *small_state(const struct small *s, const drape_world *world);
/* Returns the number of intersecting pairs that involve cloth and that no seam
 * joins; -1: the audit failed. */
int64_t small_audit(const struct small *s, const drape_world *world);
/* All bits of enum drape_outcome. */
enum { OUTCOME_BITS = 127 };

#endif
