/* SPDX-License-Identifier: Apache-2.0 */
/* A small world, or the same on both backends, that calls are made on in any
 * order. */
#ifndef FUZZ_PLAY_H
#define FUZZ_PLAY_H

#include "fuzz/small.h"

struct play {
    struct small s;
    struct bytes b;
    drape_world *world[2]; /* the same scene; [1] NULL: one alone */
    struct tape kept;      /* the checkpoint to go back to; empty: none */
    struct tape before[2], after[2];
    int64_t pairs; /* that intersect now, -1: not known */
    double time;   /* s, of the last report */
    int steps, most_steps;
};

/* Each is one call with its checks: NULL, or what does not hold. */
typedef const char *play_call(struct play *p);
play_call play_step, play_again;

/* What the checkpoint of each world is now; whether they are the same. */
bool play_note(struct play *p, struct tape note[2]);

#endif
