/* SPDX-License-Identifier: Apache-2.0 */
/* Records the calls that change a world, for drape_record and drape_replay.
 * spec/control/control.md §7 */
#ifndef REF_RECORD_H
#define REF_RECORD_H

#include "ref/api/handle.h"
#include "ref/base/change.h"

enum record_kind {
    RECORD_STATE, /* a checkpoint follows */
    RECORD_STEP,  /* n: the outcome */
    RECORD_WAKE,
    RECORD_WIND,       /* drape_wind */
    RECORD_GRAVITY,    /* 3 numbers */
    RECORD_MATERIAL,   /* of cloth `at`: drape_material */
    RECORD_POSITIONS,  /* of vertices at … at + n - 1: n vectors */
    RECORD_VELOCITIES, /* likewise */
    RECORD_PINS,       /* of cloth `at`: n particles; n vectors or none */
    RECORD_OBSTACLE,   /* obstacle `at`: n vectors */
    RECORD_POSE,       /* obstacle `at`: struct record_pose */
    RECORD_CLOTH,      /* n: bytes; at: record_mark(n) */
    RECORD_MESH,       /* an obstacle, likewise */
    RECORD_REMOVE,     /* body `at` */
    RECORD_SEAM,       /* seam `at`, of n points: n vectors, or none */
    RECORD_PANEL,      /* a cloth that is a panel, as RECORD_CLOTH */
    RECORD_KINDS
};

struct record_pose {
    double position[3], rotation[4], pivot[3];
};

/* What each record begins with. */
struct record_head {
    char magic[4];
    uint32_t kind; /* enum record_kind */
    int64_t at, n;
    uint64_t bytes; /* that follow; of RECORD_STATE 0: a checkpoint follows,
                       which knows its length */
    uint64_t check; /* a hash of the head, with 0 here, and of these bytes */
};
/* The last character is the number of this format, and of the layout of the
 * structs of drape.h that records hold. */
#define RECORD_MAGIC "drL3"
/* The hash `check` of a head and of the bytes that follow it. */
uint64_t record_check(struct record_head h, const void *data);

/* A call, whose data are in two pieces, of which the second are vectors. */
struct record {
    enum record_kind kind;
    int64_t at, n;
    const void *data;
    size_t bytes;
    int64_t vectors;
    struct given x; /* [vectors] */
};

/* Writes a call, if calls are recorded. A failure to write ends the record. */
void record_call(drape_world *world, struct record call);
/* Ends the record, since a call could not be written. */
void record_lose(drape_world *world);
/* Write a body that was added. */
void record_cloth(drape_world *world, const drape_cloth *cloth);
void record_obstacle(drape_world *world, const drape_obstacle *obstacle);
/* Read a body from the data of its record, which the definition then points to.
 * DRAPE_OK, or DRAPE_EMATCH if the record has not the size that it says. */
int record_cloth_of(const uint8_t *data, int64_t bytes, drape_cloth *cloth);
int record_panel_of(const uint8_t *data, int64_t bytes, drape_cloth *cloth,
                    drape_panel *panel);
int record_obstacle_of(const uint8_t *data, int64_t bytes,
                       drape_obstacle *obstacle);
/* What `at` of a body's record must be. Memory for n bytes is taken before
 * their hash is seen, so n has a hash of its own. */
int64_t record_mark(int64_t n);
/* Writes the state that was loaded, if calls are recorded. */
void record_state(drape_world *world);

#endif
