/* SPDX-License-Identifier: Apache-2.0 */
/* Into how many slices a step is cut. spec/world/step.md §7 */
#ifndef REF_SLICE_H
#define REF_SLICE_H

#include <stdbool.h>

#include "ref/base/real.h"
#include "spec/drape.h"

struct broad;
struct world;

/* The step that is under way. */
struct slicing {
    int level;   /* a slice is 2^-level of the step */
    int least;   /* level that a slice which went wrong asks for */
    int deepest; /* level of def.max_slices */
    int done;    /* 1/64 of the step */
    int slices;  /* done so far */
    int tries, energy_retries; /* slices taken again, of each kind */
    int began;                 /* of jolts, those of steps before: §7.5 */
    int cuts;           /* slices taken again, shorter, as they diverged */
    bool gained;        /* §7.5: a slice did, half of what is wrong or more */
    bool without_press; /* warm.md §5: the slice does without press */
    real travel;        /* m², §7.2 of the slice under way, at most */
};

/* What steps before have taught, §7.5; kept in checkpoints. */
struct caution {
    int level; /* at which a step begins */
    int again; /* 1: the last step that could go wrong did */
    int calm;  /* steps that did not, of this level */
    int far;   /* 0, or the level at which the last step's way was short enough:
                  §7.2's */
    int blind; /* steps running that began at it */
};

void slice_begin(struct world *w);
/* Sets w->dt to the slice's; returns the time at its end. */
double slice_time(struct world *w);
/* Whether the step is done. */
bool slice_last(const struct world *w);
/* §7.2: whether candidates that move `travel` at most (m², its square) move
 * too far for this slice; and makes it as short as they need. */
bool slice_too_far(struct world *w, real travel);
void slice_cut(struct world *w);
/* Whether the fail-safe ended it. */
static inline bool slice_failed(int outcome)
{
    return outcome & (DRAPE_ZONES | DRAPE_ROLLBACK | DRAPE_TRAPPED);
}
/* §7.3: whether it would be taken again if the fail-safe ended it; and the
 * rounds of impulses before that would. */
bool slice_can_retry(const struct world *w);
int slice_rounds(const struct world *w);
/* §7.3: whether energy from nowhere is looked for: nothing feeds the scene. */
bool slice_checks_energy(const struct world *w);
/* §7.3: whether the slice is to be taken again, shorter, as it ended by the
 * fail-safe, or with energy from nowhere: before, after [3]: kinetic, elastic,
 * of gravity, J. */
bool slice_wrong(struct world *w, int outcome, const double before[3],
                 const double after[3]);
/* Whether a slice that diverged is to be taken again: without press, or else
 * shorter. */
bool slice_diverged(struct world *w);
/* The slice is the state: on to the next. */
void slice_keep(struct world *w);
/* The step is done: what the next one is to know. */
void slice_end(struct world *w);
/* Adds the time since *last to a part of the report, but for the seconds
 * within that are another part's; waits for the backend. */
void slice_charge(const struct world *w, drape_step_report *r,
                  enum drape_part part, double *last, double within);
/* Moves what the queries did into a report's work. */
void slice_count(drape_work *work, struct broad *b);
/* Adds a slice's report to the step's; of one that is taken again, only what
 * it cost. */
void slice_report(drape_step_report *all, const drape_step_report *one,
                  bool kept);

#endif
