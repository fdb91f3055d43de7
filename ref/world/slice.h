/* SPDX-License-Identifier: Apache-2.0 */
/* Decides into how many slices a step is cut, and which slices are taken again.
 * spec/world/step.md §7 */
#ifndef REF_SLICE_H
#define REF_SLICE_H

#include <stdbool.h>

#include "ref/base/real.h"
#include "spec/drape.h"

struct broad;
struct world;

/* How the current step is cut. */
struct slicing {
    int level;   /* the current slice is 2^-level of the step */
    int least;   /* the level stays at least this for the rest of the step */
    int deepest; /* the level of def.max_slices */
    int done;    /* the part of the step that is done, in 1/64 of it */
    int slices;  /* slices that are done */
    int tries;   /* slices taken again after the fail-safe */
    real travel; /* m², bound of the squared relative displacement of
                    candidates in the current slice, §7.2 */
};

/* Starts the slicing of a step. */
void slice_begin(struct world *w);
/* Sets w->dt to the length of the current slice, s. Returns the time at the end
 * of the slice, s. */
double slice_time(struct world *w);
/* Returns the part of the step that is done at the end of the slice, 0 … 1. */
double slice_part(const struct world *w);
/* Whether all slices of the step are done. */
bool slice_last(const struct world *w);
/* §7.2: whether candidates move too far for this slice and a shorter slice is
 * allowed. travel: a bound of the squared relative displacement, m². */
bool slice_too_far(struct world *w, real travel);
/* Makes the slice as short as its displacements need. */
void slice_cut(struct world *w);
/* Whether the fail-safe ended a slice with this outcome. */
static inline bool slice_failed(int outcome)
{
    return outcome & (DRAPE_ZONES | DRAPE_ROLLBACK | DRAPE_TRAPPED);
}
/* §7.3: whether the current slice will be taken again if the fail-safe ends
 * it. */
bool slice_can_retry(const struct world *w);
/* §7.3: returns the number of rounds of impulses before the fail-safe. */
int slice_rounds(const struct world *w);
/* §7.3: whether the slice must be taken again, shorter, because the fail-safe
 * ended it. */
bool slice_wrong(struct world *w, int outcome);
/* §7.5: whether a slice that diverged is taken again, shorter. */
bool slice_diverged(struct world *w);
/* Records that the slice was kept, and chooses the level of the next, §7.4. */
void slice_keep(struct world *w);
/* Measures a part of the step: waits for the backend, then adds the seconds
 * since *last to this part of the report, less `within`, the seconds in between
 * that were added to other parts. Sets *last to now. Without a report from the
 * caller it neither waits nor adds. */
void slice_charge(const struct world *w, drape_step_report *r,
                  enum drape_part part, double *last, double within);
/* Moves the broad phase's counters into the work of a report: the counters are
 * 0 afterwards. */
void slice_count(drape_work *work, struct broad *b);
/* Adds the report of a slice to the report of its step. Of a slice that is not
 * kept only the costs are added: iterations, rounds, candidates, work, time. */
void slice_report(drape_step_report *all, const drape_step_report *one,
                  bool kept);

#endif
