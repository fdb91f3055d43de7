/* SPDX-License-Identifier: Apache-2.0 */
/* Decides into how many slices a step is cut, and which slices are taken again.
 * spec/world/step.md §7 */
#include "ref/world/slice.h"

#include "ref/base/clock.h"
#include "ref/world/state.h"

/* STEP_UNITS: a step in units of the shortest slice. TRIES: how many slices of
 * a step may be taken again after the fail-safe. ROUNDS: most rounds of
 * impulses in a slice that is a whole step, may be taken again, and whose
 * contacts are not solved with the cloths. */
enum { STEP_UNITS = 64, TRIES = 3, ROUNDS = 12 };
/* §7.2: how many cells candidates may move relative to each other in a slice
 * whose contacts are not solved with the cloths. */
static const real CELLS = 4;

static int slice_units(const struct slicing *s)
{
    return STEP_UNITS >> s->level;
}

/* Returns the square of the relative displacement that §7.2 allows, m². */
static real allowed_displacement(const struct world *w)
{
    real way = CELLS * w->cell;
    return way * way;
}

void slice_begin(struct world *w)
{
    struct slicing s = {0};
    while (2 << s.deepest <= w->def.max_slices)
        s.deepest++;
    w->slicing = s;
}

double slice_time(struct world *w)
{
    const struct slicing *s = &w->slicing;
    w->dt = w->def.dt / (1 << s->level);
    double part = (double)(s->done + slice_units(s)) / STEP_UNITS;
    return ((double)w->step + part) * w->def.dt;
}

double slice_part(const struct world *w)
{
    return (double)(w->slicing.done + slice_units(&w->slicing)) / STEP_UNITS;
}

bool slice_last(const struct world *w)
{
    return w->slicing.done == STEP_UNITS;
}

bool slice_too_far(struct world *w, real travel)
{
    w->slicing.travel = travel;
    return w->slicing.level < w->slicing.deepest &&
           travel > allowed_displacement(w);
}

void slice_cut(struct world *w)
{
    for (; slice_too_far(w, w->slicing.travel); w->slicing.level++)
        w->slicing.travel /= 4;
}

bool slice_can_retry(const struct world *w)
{
    const struct slicing *s = &w->slicing;
    return s->tries < TRIES && s->level < s->deepest;
}

int slice_rounds(const struct world *w)
{
    int most = w->def.max_rounds;
    if (!slice_can_retry(w))
        return most;
    if (w->plan.solves)
        return 0;
    return w->slicing.level == 0 && most > ROUNDS ? ROUNDS : most;
}

bool slice_wrong(struct world *w, int outcome)
{
    struct slicing *s = &w->slicing;
    if (!slice_failed(outcome) || !slice_can_retry(w))
        return false;
    s->tries++;
    s->least = ++s->level;
    return true;
}

bool slice_diverged(struct world *w)
{
    struct slicing *s = &w->slicing;
    if (s->level >= s->deepest)
        return false;
    s->least = ++s->level;
    return true;
}

void slice_keep(struct world *w)
{
    struct slicing *s = &w->slicing;
    s->done += slice_units(s);
    s->slices++;
    bool even = s->done % (2 * slice_units(s)) == 0;
    if (s->level > s->least && even && 4 * s->travel <= allowed_displacement(w))
        s->level--;
}

void slice_count(drape_work *work, struct broad *b)
{
    work->queries += b->queries;
    work->boxes += b->refitted;
    work->boxes_kept += b->kept;
    work->walked += b->walked;
    work->cleared += b->cleared;
    b->queries = 0;
    b->refitted = b->kept = b->walked = b->cleared = 0;
}

/* Adds the work of one slice, kept or not, to the work of the step. */
static void add_work(drape_work *all, const drape_work *one)
{
    all->tries++;
    all->solves += one->solves;
    all->queries += one->queries;
    all->narrow += one->narrow;
    all->boxes += one->boxes;
    all->boxes_kept += one->boxes_kept;
    all->walked += one->walked;
    all->cleared += one->cleared;
    all->near += one->near;
    all->later += one->later;
}

void slice_report(drape_step_report *all, const drape_step_report *one,
                  bool kept)
{
    all->iterations += one->iterations;
    all->rounds += one->rounds;
    all->candidates += one->candidates;
    add_work(&all->work, &one->work);
    for (int k = 0; k < DRAPE_PART_COUNT; k++)
        all->seconds[k] += one->seconds[k];
    all->slices += kept;
    if (!kept)
        return;
    all->outcome |= one->outcome;
    all->residual =
        one->residual > all->residual ? one->residual : all->residual;
    all->substeps =
        one->substeps > all->substeps ? one->substeps : all->substeps;
    all->contacts = one->contacts;
    all->impacts += one->impacts;
    all->zone_vertices += one->zone_vertices;
    all->rolled_back += one->rolled_back;
    all->kinetic = one->kinetic;
    all->elastic = one->elastic;
    all->potential = one->potential;
}

void slice_charge(const struct world *w, drape_step_report *r,
                  enum drape_part part, double *last, double within)
{
    if (!w->reported) /* nobody reads seconds: a device need not be waited for
                       */
        return;
    w->run->wait(w->on);
    double t = clock_now();
    r->seconds[part] += t - *last - within;
    *last = t;
}
