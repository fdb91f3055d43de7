/* SPDX-License-Identifier: Apache-2.0 */
/* One cloth of a world: its model, its part of the streams, its stages and its
 * pins. spec/world/step.md */
#ifndef REF_SHEET_H
#define REF_SHEET_H

#include "ref/cloth/cloth.h"
#include "ref/cloth/dynamics.h"
#include "ref/solve/solver.h"
#include "ref/world/kinematics.h"

struct gpu_sheet;

/* Pins that the caller has set and moves: control.md §4. */
struct caller_pins {
    bool on;       /* false: the definition's pins hold */
    int64_t n;     /* pins */
    int32_t *list; /* [n] the particle of each pin, on the host */
    int32_t *at;   /* [n] the same in the memory of the backend */
    vec *x;        /* [n] m, where the pins end */
};

/* One cloth: its model, its part of the streams, its stages, and its pins. */
struct sheet {
    struct cloth cloth;
    drape_cloth made; /* its scalars and its own panel; the material is the
                         current one */
    drape_material defined; /* the definition's material */
    struct caller_pins caller_pins;
    int64_t first, first_triangle; /* where the cloth begins in the streams */
    int size;                      /* tree_size of its start */
    struct dynamics dynamics;
    struct solver solver;
    struct kinematics pins;
    int32_t *pinned;          /* [pins.n] the particle of each pin */
    struct gpu_sheet *device; /* streams of a device alone; NULL: none */
};

/* The pins of a cloth that hold now. */
struct pins {
    int64_t n;
    const int32_t *at; /* [n] the particle of each pin */
    vec *x;            /* [n] m, where the pins end */
};
static inline struct pins sheet_pins(const struct sheet *s)
{
    if (s->caller_pins.on)
        return (struct pins){s->caller_pins.n, s->caller_pins.at,
                             s->caller_pins.x};
    return (struct pins){s->pins.n, s->pinned, s->pins.x};
}

#endif
