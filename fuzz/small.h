/* SPDX-License-Identifier: Apache-2.0 */
/* Draws a small world from choices. All its parts are valid. */
#ifndef FUZZ_SMALL_H
#define FUZZ_SMALL_H

#include "fuzz/draw.h"

enum { SMALL_SIDE = 9, SMALL_PINS = 4, SMALL_KEYS = 3 };

struct small {
    drape_def def;
    drape_cloth cloth[2];
    drape_obstacle obstacle[3];
    drape_motion motion;
    double time[SMALL_KEYS], position[SMALL_KEYS][3], rotation[SMALL_KEYS][4];
    drape_pin pin[2][SMALL_PINS];
    double velocity[2][SMALL_SIDE * SMALL_SIDE][3];
    uint8_t hole[SMALL_SIDE * SMALL_SIDE], cut[SMALL_SIDE * SMALL_SIDE];
    double box_x[8][3], ground_x[4][3], frame[2][4][3];
    bool led; /* set by callers that lead pins or obstacles: what the definition
                 holds at rest may move */
    struct bank host, device;
};

/* Draws a world. s must not move in memory while a world of it exists. A stream
 * of zeros gives one cloth of 3 × 3 in the air. */
void small_make(struct small *s, struct bytes *b);

/* Checks a state. Returns NULL or the fault: a number that is not finite, or a
 * held particle or an obstacle at rest that has moved. */
const char *small_state(const struct small *s, const drape_world *world);
/* Returns the number of intersecting pairs that involve cloth; -1: the audit
 * failed. */
int64_t small_audit(const struct small *s, const drape_world *world);
/* All bits of enum drape_outcome. */
enum { OUTCOME_BITS = 127 };

#endif
