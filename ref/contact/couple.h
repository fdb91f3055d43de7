/* SPDX-License-Identifier: Apache-2.0 */
/* Contacts within the implicit solve of all cloths. spec/contact/penalty.md §4
 */
#ifndef REF_COUPLE_H
#define REF_COUPLE_H

#include "ref/base/arena.h"
#include "ref/contact/penalty.h"
#include "ref/solve/joint.h"

struct pcg;
struct world;

/* warm.md §3, §2: how much is kept of what contacts pressed with; to how
 * many times as much it may grow in a slice; by what part of the reach it may
 * move what was not pressed. */
#define COUPLE_KEPT R(0.75)
#define COUPLE_GROWTH R(2.0)
#define COUPLE_GUST R(0.25)
/* penalty.md §1: a contact's stiffness by the largest stretch of a cloth. */
#define COUPLE_SOFT R(0.1)

/* Turns that the contacts of a slice take, or one less where nothing is left to
 * do. penalty.md §4.3 */
enum { COUPLE_TURNS = 3 };
/* How often friction follows the loads that the last one found, §4.7. */
enum { COUPLE_FOLLOWS = 4 };
/* Of these turns the first and the last one begin along what they solved
 * before, penalty.md §4.5. */
enum { COUPLE_ENDS = 2 };

struct couple {
    struct penalty penalty;  /* nv, w, stiffness, dt, tau, slip, streams */
    vec *g;                  /* [nc] N·s, A times the change so far */
    vec *given;              /* [nc] N·s, what contacts gave so far, §4.7 */
    vec *press;              /* [nv] N, warm.md; penalty's guess */
    vec *b;                  /* [nc] force - g */
    vec *found[COUPLE_ENDS]; /* [nc] m/s, what these turns solved */
    bool kept[COUPLE_ENDS];  /* whether found has it */
    struct joint joint;      /* of its members only streams, scale and square
                                last from one turn to the next */
    int turn, turns;         /* the next one of those under way; how many */
    int64_t cap;             /* contacts that the scratch is for */
    bool rough;              /* the motion before contact was solved so, with
                                the press of the slice before */
    bool moved;              /* one solve moved all cloths: couple_move */
    int iterations, solves;  /* out: of joint, this step */
    int follows;             /* out: of solves, those of §4.7 */
    bool calm;               /* no solve came after the last of penalty */
    int outcome;             /* out: enum drape_outcome, this step */
    double residual;         /* out: of the last solves */
    double seconds;          /* out: this step */
};

/* How well the motion of a cloth without contact must be solved: whether
 * roughly. */
bool couple_prepare(const struct world *w, struct pcg *p);
/* §4.1: moves all cloths without contact by one solve and sets w->couple.moved;
 * false: they must be moved one by one. DRAPE_OK or the status of a stage. */
int couple_move(struct world *w, drape_step_report *r);
/* Before the first contacts of a step. */
void couple_start(struct world *w);
/* response's solve; user is the world. With n = 0 one turn. §4.6 */
int couple_solve(void *user, int64_t n, struct contact *contact);

#endif
