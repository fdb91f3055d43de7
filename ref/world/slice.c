/* SPDX-License-Identifier: Apache-2.0 */
/* Decides into how many slices a step is cut, and which slices are taken again.
 * spec/world/step.md §7 */
#include "ref/world/slice.h"

#include "ref/base/clock.h"
#include "ref/world/state.h"

/* WHOLE: a step in units of the shortest slice. TRIES, JOLTS: how many slices
 * of a step may be taken again after the fail-safe, and for a gain of energy.
 * CALM: steps after which a level of caution is lowered. ROUNDS: most rounds of
 * impulses in a slice that is a whole step and may be taken again. */
enum { WHOLE = 64, TRIES = 3, JOLTS = 1, CALM = SLICE_CALM, ROUNDS = 12 };
/* §7.2: how many cells candidates may move relative to each other in a slice
 * of an implicit integrator, in one where gains of energy could not be seen or
 * more cells did harm, and in one of an explicit integrator. */
static const real CELLS = 16, STRICT_CELLS = 8, FEW_CELLS = 4;

static int unit(const struct slicing *s)
{
    return WHOLE >> s->level;
}

/* Returns the square of a displacement by so many cells, m². */
static real way_of(const struct world *w, real cells)
{
    real way = cells * w->cell;
    return way * way;
}

/* Returns the square of the relative displacement that §7.2 allows, m². */
static real allowed(const struct world *w)
{
    bool strict = w->slicing.strict || !slice_checks_energy(w);
    real cells = strict ? STRICT_CELLS : CELLS;
    return way_of(w, w->plan.implicit ? cells : FEW_CELLS);
}

/* Whether the slice moved further than the strict limit allows. */
static bool is_far(const struct world *w)
{
    return w->plan.implicit && w->slicing.travel > way_of(w, STRICT_CELLS);
}

void slice_begin(struct world *w)
{
    struct slicing s = {0};
    while (2 << s.deepest <= w->def.max_slices)
        s.deepest++;
    bool known = w->caution.level <= s.deepest;
    s.level = s.least = s.energy_retries = known ? w->caution.level : s.deepest;
    s.began = s.energy_retries;
    if (w->caution.far > s.level && w->caution.far <= s.deepest)
        s.level = w->caution.far;
    w->slicing = s;
}

double slice_time(struct world *w)
{
    const struct slicing *s = &w->slicing;
    w->dt = w->def.dt / (1 << s->level);
    double part = (double)(s->done + unit(s)) / WHOLE;
    return ((double)w->step + part) * w->def.dt;
}

double slice_part(const struct world *w)
{
    return (double)(w->slicing.done + unit(&w->slicing)) / WHOLE;
}

bool slice_last(const struct world *w)
{
    return w->slicing.done == WHOLE;
}

bool slice_too_far(struct world *w, real travel)
{
    w->slicing.travel = travel;
    return w->slicing.level < w->slicing.deepest && travel > allowed(w);
}

void slice_cut(struct world *w)
{
    for (; slice_too_far(w, w->slicing.travel); w->slicing.level++)
        w->slicing.travel /= 4;
}

/* §7.3: returns the energy in J that repulsion may add, since it moves a pair
 * by at most a tenth of the reach in a slice: that of lifting all mass by this
 * much, and of moving it at the speed of this displacement. */
static double lift(const struct world *w)
{
    const double *g = w->def.gravity;
    double way = 0.1 * (double)w->reach, speed = way / w->dt;
    double weight = sqrt(g[0] * g[0] + g[1] * g[1] + g[2] * g[2]);
    return w->mass * (way * weight + speed * speed / 2);
}

bool slice_can_retry(const struct world *w)
{
    const struct slicing *s = &w->slicing;
    return s->tries < TRIES && s->level < s->deepest;
}

int slice_rounds(const struct world *w)
{
    bool few = w->slicing.level == 0 && slice_can_retry(w);
    return few && w->def.max_rounds > ROUNDS ? ROUNDS : w->def.max_rounds;
}

bool slice_checks_energy(const struct world *w)
{
    return w->plan.implicit && !w->leads && !w->plan.wind;
}

bool slice_wrong(struct world *w, int outcome, const double before[3],
                 const double after[3])
{
    struct slicing *s = &w->slicing;
    bool failed = slice_failed(outcome) && s->tries < TRIES;
    double rise = (after[0] - before[0]) + (after[1] - before[1]) +
                  (after[2] - before[2]);
    double height = after[2] < 0 ? -after[2] : after[2];
    double least = (after[0] + after[1]) / 16 + height / 65536 + lift(w);
    bool gains = !failed && slice_checks_energy(w) && rise > least;
    /* what no later slice gives back */
    bool blast = rise > 2 * lift(w) + (before[0] + before[1]) / 4;
    bool few = s->energy_retries < JOLTS || s->energy_retries == s->began;
    bool jolt = gains && rise > 2 * least && (few || blast);
    bool shorter = s->level < s->deepest;
    bool far = shorter && (failed || gains) && is_far(w);
    s->gained |= gains && !far;
    s->strict |= far;
    if (!shorter || !(failed || jolt || far))
        return false;
    s->tries += failed;
    s->energy_retries += jolt;
    s->least = ++s->level;
    return true;
}

bool slice_diverged(struct world *w)
{
    struct slicing *s = &w->slicing;
    if (state_warm(w)) {
        s->without_press = true;
        return true;
    }
    if (s->level >= s->deepest)
        return false;
    s->cuts++;
    s->strict |= is_far(w);
    s->least = ++s->level;
    return true;
}

void slice_keep(struct world *w)
{
    struct slicing *s = &w->slicing;
    s->without_press = false;
    s->done += unit(s);
    s->slices++;
    bool even = s->done % (2 * unit(s)) == 0;
    if (s->level > s->least && even && 4 * s->travel <= allowed(w))
        s->level--;
}

/* §7.2: sets the level at which the next step starts for its displacements.
 * After CALM such steps a step starts with 0 again, as displacements may have
 * become shorter. */
static void predict_level(struct caution *c, const struct slicing *s)
{
    int far = s->level > s->least ? s->level : 0;
    c->blind = far && c->far ? c->blind + 1 : 0;
    c->far = c->blind < CALM ? far : 0;
}

/* §7.5: raises the level at which steps start to `level`, at least. */
static void caution_raise(struct caution *c, int level)
{
    c->level = c->level > level ? c->level : level;
}

void slice_end(struct world *w)
{
    const struct slicing *s = &w->slicing;
    struct caution *c = &w->caution;
    predict_level(c, s);
    int wrong = s->energy_retries + s->tries;
    if (s->cuts || s->gained || (c->again && wrong > s->began))
        caution_raise(c, s->cuts ? s->least : JOLTS);
    if (s->cuts || s->gained || wrong > s->began) {
        c->again = 1;
        c->calm = 0;
    } else if (c->level == 0) {
        c->again = 0;
    } else if (++c->calm == CALM) {
        c->level--;
        c->calm = 0;
    }
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
