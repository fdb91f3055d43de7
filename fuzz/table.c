/* SPDX-License-Identifier: Apache-2.0 */
/* The table of targets: every stage, every function of spec/drape.h. Functions
 * that take only a world are called in any order by the targets of calls.c;
 * each such target calls the function of its name often. */
#include "fuzz/fuzz.h"

#include <string.h>

#define STAGE(room, file, X, rule) {#X, fuzz_stage, NULL},
const struct target fuzz_targets[] = {
#include "spec/stages.def"
    {"api", fuzz_stage, NULL},
    {"vf", fuzz_stage, NULL},
    {"ee", fuzz_stage, NULL},
    {"drape_create", fuzz_create, NULL},
    {"drape_create_scale", fuzz_scale, NULL},
    {"drape_step", fuzz_calls, NULL},
    {"drape_step_many", fuzz_many, NULL},
    {"drape_step_twins", fuzz_twins, NULL},
    {"drape_read", fuzz_calls, NULL},
    {"drape_read_triangles", fuzz_calls, NULL},
    {"drape_first_vertex", fuzz_calls, NULL},
    {"drape_borrow", fuzz_calls, NULL},
    {"drape_wake", fuzz_calls, NULL},
    {"drape_set_wind", fuzz_calls, NULL},
    {"drape_set_gravity", fuzz_calls, NULL},
    {"drape_set_material", fuzz_calls, NULL},
    {"drape_set_positions", fuzz_calls, NULL},
    {"drape_set_velocities", fuzz_calls, NULL},
    {"drape_set_pins", fuzz_calls, NULL},
    {"drape_set_obstacle", fuzz_calls, NULL},
    {"drape_contacts", fuzz_calls, NULL},
    {"drape_record", fuzz_calls, NULL},
    {"drape_add_cloth", fuzz_calls, NULL},
    {"drape_add_obstacle", fuzz_calls, NULL},
    {"drape_remove", fuzz_calls, NULL},
    {"drape_set_positions_device", fuzz_calls, NULL},
    {"drape_set_velocities_device", fuzz_calls, NULL},
    {"drape_set_pins_device", fuzz_calls, NULL},
    {"drape_set_obstacle_device", fuzz_calls, NULL},
    {"drape_contacts_device", fuzz_calls, NULL},
    {"drape_clock", fuzz_calls, NULL},
    {"drape_read_material", fuzz_calls, NULL},
    {"drape_read_wind", fuzz_calls, NULL},
    {"drape_read_gravity", fuzz_calls, NULL},
    {"drape_seam_target", fuzz_calls, NULL},
    {"drape_seam_state", fuzz_calls, NULL},
    {"drape_are_sewn", fuzz_calls, NULL},
    {"drape_plan", fuzz_calls, NULL},
    {"drape_count", fuzz_calls, NULL},
    {"drape_save", fuzz_calls, NULL},
    {"drape_load", fuzz_load, load_mutate},
    {"drape_replay", fuzz_replay, replay_mutate},
    {"drape_audit", fuzz_audit, NULL},
    {"drape_ccd", fuzz_ccd, NULL},
    {"drape_ccd_frames", fuzz_ccd_frames, NULL},
    {"drape_status_text", fuzz_text, NULL},
    {NULL, NULL, NULL}};

bool fuzz_kept;

static const struct target *find(const struct target *t, const char *name)
{
    while (t->name && strcmp(t->name, name) != 0)
        t++;
    return t->name ? t : NULL;
}

const struct target *fuzz_find(const char *name)
{
    const struct target *t = find(fuzz_targets, name);
    return t ? t : find(fuzz_readers, name);
}
