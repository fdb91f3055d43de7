/* SPDX-License-Identifier: Apache-2.0 */
/* The state of a world, shared by the files that make, step, save and
 * explain it. */
#ifndef REF_STATE_H
#define REF_STATE_H

#include "ref/base/arena.h"
#include "ref/broad/broad.h"
#include "ref/cloth/dynamics.h"
#include "ref/contact/couple.h"
#include "ref/contact/response.h"
#include "ref/narrow/audit.h"
#include "ref/solve/solver.h"
#include "ref/world/kinematics.h"
#include "ref/world/plan.h"
#include "ref/world/slice.h"
#include "ref/world/world.h"

struct gpu_sheet;

/* One cloth: its model, its part of the streams, and its pins. */
struct sheet {
    struct cloth cloth;
    int64_t first, first_triangle; /* in the scene's streams */
    struct dynamics dynamics;
    struct solver solver;
    struct kinematics pins;
    int32_t *pinned;          /* [pins.n] particle of each pin */
    struct gpu_sheet *device; /* what a device has besides, or NULL */
};

/* One obstacle: how it is told to move. */
struct prop {
    int64_t first, first_triangle;
    struct kinematics place;
    double *frame; /* [frames][place.n][3], or NULL */
    int frames;
    double frame_dt;
    bool moves; /* ever */
};

/* What may collide: nothing is near anything, some is, some is in contact. */
enum nearness { NEAR_NONE, NEAR_PAIRS, NEAR_CONTACTS };

/* The state where the step under way started; watch is the host's. */
struct start {
    vec *x, *v;           /* [nv] */
    vec *past_x, *past_v; /* [nc] or NULL */
    vec *press;           /* likewise */
    double (*watch)[2];   /* [n_cloths]; NULL: no step was cut yet */
    int past, resting;
    bool pressed, asleep;
    enum nearness near;
};

/* Streams lie in the memory of the backend, but for watch. */
struct world {
    drape_def def; /* scalars and motions; of the rest, no pointer is read */
    const struct backend *run; /* who steps it */
    void *on;                  /* the backend's own */
    struct gpu_world *device;  /* NULL: the reference steps it */
    struct plan plan;
    struct arena *arena;
    const size_t *held;   /* [ARENA_PARTS] bytes, here or on the device */
    uint64_t fingerprint; /* of the whole definition, for checkpoints */

    int64_t nv, nt;          /* vertices and triangles of the scene */
    int64_t nc, ntc;         /* of these, the cloths' */
    vec *x0, *v0;            /* [nv] at the start of the step */
    vec *x1, *v1;            /* [nv] at its end */
    vec *free_x, *free_v;    /* [nc] as dynamics gave it, before contact */
    vec *past_x, *past_v;    /* [nc] the step before, for BDF2 */
    vec *press;              /* [nc] N, of contacts of the slice before */
    vec *to;                 /* [nc] where pins end; NULL: nobody reads it */
    double (*watch)[2];      /* [n_cloths] dynamics' reference and surplus */
    real *w;                 /* [nv] inverse mass, 0 for what does not yield */
    int32_t (*tri)[3];       /* [nt] */
    uint16_t *body;          /* [nv] cloth or obstacle, the skin of each */
    struct surface *surface; /* [bodies] */

    struct sheet *sheet; /* [n_cloths] */
    struct prop *prop;   /* [n_obstacles] */
    struct pose *pose;   /* [n_motions] at the time being led to, the host's */
    struct pose *posed;  /* the same in the memory of the backend */
    real reach;          /* m, at which contact begins, the largest */
    real cell;           /* m, the smallest side of a cloth's cells */
    double mass;         /* kg, of all cloths */
    struct broad broad;
    struct response response;
    struct couple couple; /* of implicit integrators */

    double broad_seconds;         /* not charged yet */
    struct trace trace, *tracing; /* tracing: NULL where nobody asked */

    int64_t step;
    double time;
    int resting; /* steps in a row in which nothing moved */
    bool asleep;
    enum nearness near;   /* of the slice before */
    bool pressed;         /* not all of press is 0 */
    int64_t intersecting; /* pairs of triangles of x0: step.md §11 */
    int past;  /* 1 + level of the slice that past_x and past_v hold, 0: none */
    double dt; /* s, of the slice under way */
    bool met;  /* contact may have changed what dynamics made of it */
    bool reported; /* somebody reads what steps report */
    struct slicing slicing;
    struct caution caution;
    struct start start;
    struct audit
        ending; /* streams of step.md §11's audit, NULL until it is needed */
};

/* Whether past_x and past_v are those of a slice as long as this one. */
static inline bool state_has_past(const struct world *w)
{
    return w->past == 1 + w->slicing.level;
}

/* Whether contacts press on in this slice: warm.md §3, §5. */
static inline bool state_warm(const struct world *w)
{
    return w->pressed && !w->slicing.without_press;
}

/* What a slice found near. */
static inline enum nearness state_nearness(const struct response *c)
{
    if (c->contacts > 0)
        return NEAR_CONTACTS;
    return c->near > 0 || c->candidates > 0 ? NEAR_PAIRS : NEAR_NONE;
}

/* ref/world/world.c, for the other files of a world and gpu/. */
int world_make(const drape_def *def, struct arena *arena, struct world **world,
               drape_error *error);
int world_read(const struct world *w, double (*x)[3], double (*v)[3]);
void world_read_triangles(const struct world *w, int32_t (*tri)[3]);
int64_t world_first_vertex(const struct world *w, int body);
int64_t world_first_triangle(const struct world *w, int body);
void world_wake(struct world *w);
/* DRAPE_OK, or DRAPE_EARG where the plan has no wind and this is some. */
int world_set_wind(struct world *w, const drape_wind *wind);

#endif
