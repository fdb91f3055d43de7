/* SPDX-License-Identifier: Apache-2.0 */
/* The law by which a scene's garments are sewn: app/patterns/README.md §11. */
#ifndef APP_SCENE_SEWING_H
#define APP_SCENE_SEWING_H

#include "app/scene/scene.h"

/* Seams are drawn together in this order. Then the garment is worn, with
 * gravity and friction; and then the bodies move, from their time 0 on. */
enum sewing_stage {
    SEWING_DARTS,  /* seams within a panel whose edges meet */
    SEWING_AROUND, /* those of panels that face each other across a limb, so
                      that it is within before anything draws them off it */
    SEWING_SEAMS,  /* the others, together: what closes later holds in its place
                      what closes before */
    SEWING_ACROSS, /* those that cross the end of one of these: while that is
                      open, the panel that they draw to it goes through */
    SEWING_FREE,   /* what is open then, without the friction of bodies */
    SEWING_WORN,
    SEWING_MOVING,
    SEWING_STAGES
};
extern const char *const sewing_stages[SEWING_STAGES];

struct sewing_seam {
    enum sewing_stage stage; /* in which its turn comes */
    int64_t n;
    int index;           /* in the world; -1: it is not in it yet */
    double start;        /* m, the mean of its gaps at the start */
    bool held;           /* so far, until its turn comes */
    bool told;           /* the world has these targets */
    double spacing;      /* m, mean length of the seam a point */
    double (*gap)[3];    /* [n] m, particle - place, after the last step */
    double (*pull)[3];   /* [n] N, on the particle, in the last step */
    double (*target)[3]; /* [n] m */
    int waiting;         /* points that pull as hard as they may */
    double most;         /* m, the largest gap */
    int worst;           /* the point that has it */
    double strongest;    /* N/m, the largest pull of a point a spacing */
    int64_t closed; /* step after which it was closed last; 0: it is open */
};

/* Particles that are held once the garment is worn. */
struct sewing_hold {
    const struct scene_attach *about;
    int index;         /* of its seam in the world; -1: it does not hold */
    bool told;         /* the world has these targets */
    int body;          /* an obstacle, that most are beside; -1: none */
    int64_t from, to;  /* steps after which it held, and no more; -1: not yet */
    struct skin *skin; /* [n] beside which each is held */
    int32_t (*onto)[2];  /* [n] its anchor, twice */
    double *part;        /* [n] 0 */
    double (*gap)[3];    /* [n] m, particle - anchor, after the last step */
    double (*pull)[3];   /* [n] N, on the particle, in the last step */
    double (*target)[3]; /* [n] m */
    double slip;         /* m, the largest way from where it is held */
    double strongest;    /* N/m, the largest pull of a point a spacing */
};

struct sewing {
    struct scene *scene;
    const struct overrides *overrides;
    drape_def whole;    /* the scene's, of which each stage changes a part */
    drape_world *world; /* of the present stage */
    double *lift;     /* [cloths] m, by which panels were lifted at the start */
    double (*way)[3]; /* [cloths] m, by which they were moved then, NULL: none
                         was */
    int *by;          /* [cloths] the panel that moved it, -1: it stayed */
    enum sewing_stage stage;
    struct sewing_seam *seam; /* [whole.n_seams] */
    struct sewing_hold *hold; /* [holds] */
    int holds;
    const double (*anchor_at)[3]; /* m, the particles of the anchors' cloth */
    drape_world *ahead;           /* bodies that move, a step ahead */
    double (*next)[3];            /* [nv] m, and where they are there */
    double heavy;                 /* the part of gravity that the world has */
    int64_t begun[SEWING_STAGES]; /* step before each; -1: skipped */
    int64_t steps, still;         /* made; without progress */
    double open, left;            /* what was to close in this stage; least */
    int64_t nv, nc, nt;           /* vertices, of cloth, triangles */
    int64_t particles;            /* of cloth that have a cell */
    double (*x)[3], (*v)[3];      /* [nv] */
    double (*was)[3];             /* [nv] m, where cloths were at ... */
    int64_t still_since;          /* ... this step; -1: none */
    bool rest;                    /* worn, and nearly nothing moves any more */
    int32_t (*tri)[3], *group;    /* [nt] for audits */
    drape_cloth *cloth;           /* of the stage */
    drape_obstacle *obstacle;
    drape_seam *turn;
    struct pool pool;
};

/* Makes the world of the first stage. The scene's definition is that of the
 * present stage until sewing_end. Returns app_exit; a failure prints one line.
 * sewing_end gives back what it holds in any case. */
int sewing_begin(struct sewing *sewing, struct scene *scene,
                 const struct overrides *overrides);
/* Makes a step, and enters the next stage where one has ended. The report's
 * step and time are those since sewing began. Returns app_exit; a failure
 * prints one line. */
int sewing_step(struct sewing *sewing, drape_step_report *report);
/* Returns the steps in which the bodies move: from time 0 to the last of their
 * frames and of their motions' keys. 0: none moves. */
int64_t sewing_moves(const struct sewing *sewing);
/* Lets the bodies move from now on. Returns app_exit. */
int sewing_move(struct sewing *sewing);
/* Counts the intersecting pairs of triangles that can collide, and those that
 * are sewn together. Returns app_exit. */
int sewing_audit(struct sewing *sewing, int64_t *pairs, int64_t *sewn);
/* Lifts panels that may move, by the least way, up to 5 cm, at which nothing is
 * in the way of a seam around a limb: app/scene/lift.c. Returns app_exit. */
int lift_panels(struct sewing *sewing, const bool *moves);
/* Attachments, app/scene/hold.c. Adds the cloth of their anchors to the scene,
 * before a world is made of it; whether they begin now, in this stage; holds
 * what is to be held where it is now, in s->x; adds the seams of what is held
 * at this time to the stage's definition; whether one of them has had its time,
 * or will; moves bodies and targets to where they are at the end of the next
 * step; reads what they are like. */
int holds_begin(struct sewing *sewing);
bool holds_may_begin(const struct sewing *sewing, enum sewing_stage stage);
void holds_bind(struct sewing *sewing);
void holds_define(struct sewing *sewing);
bool holds_are_due(const struct sewing *sewing);
bool holds_will_end(const struct sewing *sewing);
int holds_move(struct sewing *sewing);
int holds_read(struct sewing *sewing);
void holds_end(struct sewing *sewing);

/* Whether a seam is closed to 1 % of a cell. */
bool sewing_is_closed(const struct sewing *sewing, int seam);
void sewing_end(struct sewing *sewing);

#endif
