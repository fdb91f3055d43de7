/* SPDX-License-Identifier: Apache-2.0 */
/* A world: its state, its stages and their settings. Shared by the files that
 * make, step and save a world. */
#ifndef REF_STATE_H
#define REF_STATE_H

#include "ref/base/arena.h"
#include "ref/base/trace.h"
#include "ref/broad/broad.h"
#include "ref/contact/lagrange.h"
#include "ref/contact/rounds.h"
#include "ref/momentum/conserve.h"
#include "ref/narrow/audit.h"
#include "ref/world/plan.h"
#include "ref/world/sheet.h"
#include "ref/world/slice.h"

struct edited;
struct rest;
struct sleep;

/* One obstacle and its prescribed motion. */
struct prop {
    int64_t first, first_triangle;
    struct kinematics place;
    double *frame; /* [frames.count][place.n][3] m; NULL: it has no frames */
    struct sequence frames; /* its times lie on the host */
    bool moves;             /* it has a motion or frames */
    bool targeted;          /* it goes where the caller says: control.md §5 */
    int32_t *none; /* [place.n] zeros, the motion of a pose; NULL: not yet */
    struct pose *pose; /* in the memory of the backend; NULL: not yet */
};

/* Where the caller moves vertices. The streams are taken when they are first
 * needed. spec/control/control.md §3 */
struct targets {
    vec *from, *to; /* [nv] m, the start and the end of the next step */
    bool armed;     /* a target was set since the last step */
    bool stirred;   /* a mesh of class TREE_STATIC moved in the last step */
    bool planned;   /* the definition moves something, and so plan.prescribed */
    bool able;      /* the broad phase's apart.able as it was made */
};

/* How near things came in a slice: no candidate; candidates without contact;
 * contacts. */
enum nearness { NEAR_NONE, NEAR_PAIRS, NEAR_CONTACTS };

/* The streams of vectors that a step leaves to the next. */
enum { STATE_STREAMS = 8 };

/* A copy of the state at the start of the current step. `watch` lies on the
 * host, the other streams in the memory of the backend. */
struct saved_state {
    vec *stream[STATE_STREAMS]; /* of state_streams; NULL: not taken yet */
    struct pool kept;           /* struct kept */
    int64_t n_kept;
    double (*watch)[2]; /* [n_cloths]; NULL: no start was kept yet */
    enum nearness nearness;
};

/* The list of contacts that the caller asks for. All but the last three lie on
 * the host; all are NULL until they are needed. spec/control/control.md §8 */
struct list {
    bool known;          /* the response holds the contacts of the last slice */
    drape_contact *item; /* [cap] */
    struct contact *raw; /* [cap] of a device */
    struct key *key, *spare; /* [cap] */
    int64_t cap;
    double (*body)[3];    /* [bodies] N·s */
    drape_contact *there; /* [cap_there] in the memory of a device */
    int64_t cap_there;
    double (*body_there)[3];
};

/* Streams lie in the memory of the backend, except watch, which the host has.
 */
struct world {
    drape_def def; /* only its scalars and motions are used after creation */
    const struct backend *run; /* the functions of the backend */
    struct gpu *on;            /* the first argument of those functions */
    struct gpu_world *device;  /* NULL: the backend is the reference */
    struct world *home;        /* the world whose streams are on the host: this
                                  one, or the one that a device's was made of */
    struct plan plan;
    struct arena *arena;
    const size_t *held;        /* [ARENA_PARTS] bytes in the backend's memory */
    uint64_t fingerprint;      /* of the whole definition, for checkpoints */
    uint64_t *print;           /* [bodies] the same of each body */
    double defined_gravity[3]; /* the definition's */
    drape_wind defined_wind;

    int64_t nv, nt;          /* vertices and triangles of the scene */
    int64_t nc, ntc;         /* how many of these belong to cloth: the first */
    vec *x0, *v0;            /* [nv] m, m/s at the start of the slice */
    vec *x1, *v1;            /* [nv] m, m/s at its end */
    vec *free_x, *free_v;    /* [nc] m, m/s at its end without contact */
    vec *past_x, *past_v;    /* [nc] the slice before, for BDF2, or NULL */
    vec *anchor;             /* [nc] m, where cloths were when they last had
                                gone somewhere; NULL: none may sleep */
    vec *to;                 /* [nc] m, where pins end; NULL: not needed */
    double (*watch)[2];      /* [n_cloths] J, dynamics' reference, surplus */
    real *w;                 /* [nv] 1/kg, 0 for obstacles, pins, and what is
                                held asleep */
    int32_t (*tri)[3];       /* [nt] vertices of the scene */
    uint16_t *body;          /* [nv] the vertex's body: index into surface */
    struct surface *surface; /* [bodies] thickness and friction */

    struct sheet *sheet; /* [n_cloths] */
    struct prop *prop;   /* [n_obstacles] */
    struct pose *pose;   /* [n_motions] at the end of the slice, on the host */
    struct pose *posed;  /* the same in the memory of the backend */
    real reach;          /* m, the largest thickness of a cloth */
    real thinnest;       /* m, the smallest */
    real cell;           /* m, the smallest side of a cell of any cloth */
    double mass;         /* kg, of all cloths together */
    struct seams seams;
    struct broad broad;
    struct response response;
    struct lagrange lagrange; /* the motion with contacts, of implicit
                                 integrators */

    double broad_seconds;         /* s of queries, not yet in a report */
    struct trace trace, *tracing; /* tracing: &trace, or NULL: no trace */

    int64_t step;
    double time;
    enum nearness nearness; /* how near things came in the slice before */
    int64_t intersecting;   /* intersecting pairs of the state: step.md §11 */
    int64_t sewn; /* of the last step: pairs that a seam joins, if it counted */
    int past;     /* 1 + level of the slice in past_x and past_v; 0: none */
    double dt;    /* s, length of the current slice */
    bool prescribes; /* an obstacle or a pin moves in this slice */
    bool met;        /* contact may have changed x1, v1 in this slice */
    bool reported;   /* the caller gave a report to fill */
    struct slicing slicing;
    struct sleep *sleep;
    struct saved_state saved;
    struct targets targets;
    struct list list;
    struct conserve conserve;
    struct audit
        ending; /* the audit of step.md §11; its streams are taken at need */
};

/* A stream of the state. at: the member of the world that points to it. n: its
 * items, of vertices, of which those of cloth come first, or of the points of
 * seams; 0: the world does not have it. */
struct state_stream {
    vec **at;
    int64_t n;
    bool seams;
};
struct state_list {
    struct state_stream of[STATE_STREAMS];
};

/* Lists the streams of the state, in the order in which a checkpoint has them.
 * Whatever takes, restores, saves, hands over or copies a state goes over this
 * list, so that none of them can forget a stream. */
static inline struct state_list state_streams(const struct world *w)
{
    struct world *own = (struct world *)w; /* a maker sets the members */
    int64_t past = w->plan.history ? w->nc : 0, rest = w->def.sleep ? w->nc : 0;
    int64_t points = w->seams.n;
    struct state_list list = {{{&own->x0, w->nv, false},
                               {&own->v0, w->nv, false},
                               {&own->past_x, past, false},
                               {&own->past_v, past, false},
                               {&own->anchor, rest, false},
                               {&own->seams.pull, points, true},
                               {&own->seams.from, points, true},
                               {&own->seams.to, points, true}}};
    return list;
}

/* Whether past_x and past_v hold a slice of the current slice's length. */
static inline bool state_has_past(const struct world *w)
{
    return w->past == 1 + w->slicing.level;
}

/* First vertex or triangle of a body, cloths first; of the body after the last:
 * their number. */
static inline int64_t state_first_vertex(const struct world *w, int body)
{
    int cloths = w->def.n_cloths;
    if (body >= cloths + w->def.n_obstacles)
        return w->nv;
    return body < cloths ? w->sheet[body].first : w->prop[body - cloths].first;
}

static inline int64_t state_first_triangle(const struct world *w, int body)
{
    int cloths = w->def.n_cloths;
    if (body >= cloths + w->def.n_obstacles)
        return w->nt;
    return body < cloths ? w->sheet[body].first_triangle
                         : w->prop[body - cloths].first_triangle;
}

/* Numbers of the state that the API returns, on the host for either backend.
 * step and time may be NULL. */
static inline void state_clock(const struct world *w, int64_t *step,
                               double *time)
{
    if (step)
        *step = w->step;
    if (time)
        *time = w->time;
}

static inline const drape_material *state_material(const struct world *w,
                                                   int cloth)
{
    return &w->sheet[cloth].made.material;
}

static inline const drape_wind *state_wind(const struct world *w)
{
    return &w->def.wind;
}

static inline const double *state_gravity(const struct world *w)
{
    return w->def.gravity;
}

/* Returns how near things came in the slice that this response handled. */
static inline enum nearness state_nearness(const struct response *c)
{
    if (c->contacts > 0 || c->active > 0)
        return NEAR_CONTACTS;
    return c->close > 0 || c->candidates > 0 ? NEAR_PAIRS : NEAR_NONE;
}

/* Functions of ref/world/world.c that the device's world uses too. */
int world_make(const drape_def *def, struct arena *arena, struct world **world,
               drape_error *error);
/* The same for an edited world, which may start in any state; NULL: it is none.
 */
int world_make_edited(const drape_def *def, const struct edited *edited,
                      struct arena *arena, struct world **world,
                      drape_error *error);
int world_read(const struct world *w, double (*x)[3], double (*v)[3]);
void world_read_triangles(const struct world *w, int32_t (*tri)[3]);

#endif
