/* SPDX-License-Identifier: Apache-2.0 */
/* What the opaque drape_world holds. Only files of the API read it. */
#ifndef REF_HANDLE_H
#define REF_HANDLE_H

#include <stdbool.h>

#include "ref/api/ops.h"
#include "ref/base/names.h"

struct drape_world {
    struct arena arena;
    const struct world_ops *ops;
    struct world *world;
    int cloths;
    int bodies; /* cloths and obstacles */
    int precision;
    int threads; /* of a call that changes the world */
    drape_log *log;
    void *log_user;
    drape_memory gone;   /* allocations of devices of worlds that were replaced
                            as bodies came and went; its bytes are 0 */
    int64_t steps;       /* begun since the world was made */
    int64_t taken;       /* allocations that the log has reported */
    drape_write *record; /* NULL: no call is recorded */
    void *record_user;
    bool listed; /* drape_step_many is checking a list and has seen it */
    bool lost;   /* the record could not be written */
};

/* Sets what a handle says of its world, which was made of this definition. */
void handle_set(drape_world *handle, const drape_def *def, struct world *world);
/* Writes to the log what is new since the step before. */
void handle_tell_step(drape_world *world, int status);
/* Writes to the log what became of a change of bodies. */
void handle_tell_edit(drape_world *handle, int status, const char *why);

#endif
