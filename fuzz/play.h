/* SPDX-License-Identifier: Apache-2.0 */
/* A small world, or the same world on both backends, on which calls are made in
 * any order. */
#ifndef FUZZ_PLAY_H
#define FUZZ_PLAY_H

#include "fuzz/small.h"

struct play {
    struct small s;
    struct bytes b;
    drape_world *world[2]; /* the same scene; [1] is NULL if there is one
                              world */
    struct tape kept;      /* checkpoint to return to; empty: none */
    struct tape before[2], after[2];
    struct tape log; /* of the calls on world[0] */
    bool recording;
    drape_def began; /* the world's definition where the log begins */
    drape_cloth cloth[SMALL_CLOTHS];
    drape_seam seam;
    drape_obstacle obstacle[SMALL_OBSTACLES];
    int64_t pairs; /* intersecting pairs now; -1: not known */
    double time;   /* s, time of the last report */
    int steps, most_steps;
};

/* One call with its checks. Returns NULL or the check that failed. */
typedef const char *play_call(struct play *p);
play_call play_step, play_again;
/* fuzz/reads.c */
play_call play_read, play_triangles, play_first, play_borrow, play_plan,
    play_count, play_clock, play_set_material, play_set_wind, play_set_gravity;
/* fuzz/live.c */
play_call play_gravity, play_material, play_positions, play_velocities,
    play_pins, play_obstacle, play_contacts, play_log, play_positions_device,
    play_velocities_device, play_pins_device, play_obstacle_device,
    play_contacts_device, play_seam;
/* fuzz/bodies.c */
play_call play_add_cloth, play_add_obstacle, play_remove;

/* Saves the checkpoint of each world. Returns whether the checkpoints are
 * equal. */
bool play_note(struct play *p, struct tape note[2]);
/* Checks that the state is as it was before this call. Calls that must change
 * nothing end with this check. */
const char *play_unchanged(struct play *p);
/* Makes allocations fail in one call of eight. */
void play_short(struct play *p);
/* Ends a call of live control with the statuses of both worlds: both are the
 * same, and a refused call has changed nothing. wrong: whether it had to be
 * refused. */
const char *play_judge(struct play *p, const int status[2], bool wrong);

#endif
