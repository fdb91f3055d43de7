/* SPDX-License-Identifier: Apache-2.0 */
/* A joint solve that begins along a direction it is given, and which directions
 * a world gives. spec/contact/penalty.md §4.5 */
#include "ref/solve/jacobi.h"
#include "ref/solve/joint.h"
#include "ref/world/state.h"
#include "ref/world/step.h"
#include "tests/solve/system.h"
#include "tests/world/slab.h"

enum { MOST = 2 * SLAB_SMALL * SLAB_SMALL, STEPS = 12 };
/* Differences of such numbers overflow. */
#define HUGE_REAL (REAL_BITS == 32 ? R(0x1p127) : (real)0x1p1023)

/* Stands in place of the reference's joint solve. */
static struct spy {
    int (*joint)(struct world *w, struct joint *s);
    const char *failed;
    int recalled;     /* solves along a direction */
    int soon;         /* steps of two turns */
    int hits;         /* first turns of cloths that hit each other */
    bool broken;      /* whether the solve before broke down */
    vec undone[MOST]; /* its b */
    int turns;        /* of this step; COUPLE_TURNS: all */
    bool spoils;      /* makes those solves fail */
    vec found[COUPLE_ENDS][MOST]; /* what the last ones found that did not */
    double scale, square;         /* of the solve before */
} spy;

/* Solves the same system again from what *start says, along `last`. */
static struct joint again(struct world *w, const struct joint *start,
                          const vec *last)
{
    struct joint s = *start;
    s.last = last;
    spy.joint(w, &s);
    return s;
}

static double dot_of(int64_t n, const vec *a, const vec *b)
{
    double sum = 0;
    for (int64_t k = 0; k < n; k++)
        sum += (double)vec_dot(a[k], b[k]);
    return sum;
}

/* One step along a direction takes the best length: the residual that is left
 * lies across it. A length that is wrong by a part e leaves dv·r = e dv·b, the
 * energy that the step gains being dv·b / 2; e is asked to be below 1/64. */
static bool steps_well(struct world *w, const struct joint *start, const vec *d)
{
    struct joint s = *start;
    s.max_iterations = 1;
    s = again(w, &s, d);
    double gained = dot_of(s.nc, s.dv, s.b);
    return s.iterations == 1 && s.outcome == PCG_LIMIT && gained > 0 &&
           fabs(dot_of(s.nc, s.dv, s.r)) <= gained / 64;
}

/* §4.2: the part of M⁻¹ r that a step took, by Jacobi, whose factors the solve
 * has left in the sheets. */
static double part_taken(const struct world *w, const vec *step, const vec *r)
{
    double along = 0, all = 0;
    for (int k = 0; k < w->def.n_cloths; k++)
        for (int64_t i = 0; i < w->sheet[k].cloth.count; i++) {
            int64_t at = w->sheet[k].first + i;
            vec z = factor_solve(w->sheet[k].solver.pcg.factor[i], r[at]);
            along += (double)vec_dot(step[at], z);
            all += (double)vec_dot(z, z);
        }
    return along / all;
}

/* §4.2: the last step lowers the energy. A solve that runs out of iterations
 * does not take it, so it is the difference z of two solutions; from a residual
 * r to r' it lowers the energy by z·(r + r') / 2. */
static bool ends_well(struct world *w, const struct joint *start,
                      const struct joint *ended)
{
    static vec dv[MOST], r[MOST];
    struct joint s = *start;
    double gain = 0;
    memcpy(dv, ended->dv, (size_t)start->nc * sizeof *dv);
    memcpy(r, ended->r, (size_t)start->nc * sizeof *r);
    s.max_iterations = ended->iterations;
    s = again(w, &s, NULL);
    for (int64_t k = 0; k < s.nc; k++) {
        dv[k] = vec_sub(dv[k], s.dv[k]);
        gain += (double)vec_dot(dv[k], vec_add(r[k], s.r[k]));
    }
    bool jacobi = w->def.precond == DRAPE_JACOBI;
    double part = jacobi ? part_taken(w, dv, s.r) : 2.0 / 3;
    return s.outcome == PCG_LIMIT && gain > 0 && fabs(part - 2.0 / 3) < 0.02;
}

static const char *solve_ways(struct world *w, const struct joint *start)
{
    static vec zero[MOST], huge[MOST], dv[MOST], noise[MOST];
    struct joint none = again(w, start, NULL), s;
    size_t bytes = (size_t)start->nc * sizeof *dv;
    EXPECT(start->nc <= MOST && none.outcome == PCG_CONVERGED);
    memcpy(dv, none.dv, bytes);
    EXPECT(none.iterations == 0 || ends_well(w, start, &none));
    s = again(w, start, zero);
    EXPECT(s.iterations == none.iterations + 1 && s.scale == none.scale);
    EXPECT(none.iterations == 0 || !memcmp(s.dv, dv, bytes));
    /* such as only a forged checkpoint holds: products with it overflow */
    for (int64_t k = 0; k < start->nc; k++)
        huge[k].y = w->w[k] > 0 ? (k % 2 ? HUGE_REAL : -HUGE_REAL) : 0;
    s = again(w, start, huge);
    EXPECT(none.iterations == 0 || !memcmp(s.dv, dv, bytes));
    s = again(w, start, dv);
    EXPECT(s.outcome == PCG_CONVERGED);
    EXPECT(s.iterations <= 3 + none.iterations / 4);
    EXPECT(s.scale == none.scale || (!start->weigh && s.scale < none.scale));
    if (none.iterations == 0)
        return NULL; /* b met the tolerance: dv is 0 */
    double size = sqrt(dot_of(start->nc, dv, dv) / (double)start->nc);
    for (int64_t k = 0; k < start->nc; k++) {
        double some = w->w[k] > 0 ? size * noise_of((uint64_t)k) : 0;
        noise[k] = vec_axpy(dv[k], (real)some, vec_make(1, -1, 2));
    }
    EXPECT(steps_well(w, start, noise) && steps_well(w, start, dv));
    /* an r that lost the first step would leave its whole product in the true
     * residual, many times the tolerance */
    s = again(w, start, noise);
    EXPECT(s.outcome == PCG_CONVERGED && s.residual <= 2 * start->exact);
    return NULL;
}

/* §4.3: whether the next turn is the last: the third, or the second if its b
 * meets ten tolerances as it is. */
static bool is_last(const struct joint *s, double asked)
{
    double b = dot_of(s->nc, s->b, s->b);
    double part = sqrt(b / spy.square) / (10 * asked);
    if (spy.turns == 1 && fabs(part - 1) < 1e-3)
        return s->last; /* rounding decides */
    return spy.turns + 1 == COUPLE_TURNS || (spy.turns == 1 && part < 1);
}

/* §4.3: how many tolerances |r| of a turn meets: ten, a hundred in the first
 * turn of cloths that hit each other, one in the last. */
static double exact_of(const struct world *w, bool ends)
{
    bool hits = w->near == NEAR_IMPACTS && w->def.n_cloths > 1;
    spy.hits += hits && spy.turns == 0;
    return ends ? 1 : spy.turns == 0 && hits ? 100 : 10;
}

/* §4.3: the tolerances of a turn, and what they are relative to: until the last
 * turn pushes count e times, what the scale was before such a turn, and is
 * before the last. A turn like the one before goes on with its scale, divided
 * again. */
static const char *check_care(const struct world *w, const struct joint *s)
{
    const struct penalty *p = &w->couple.penalty;
    double asked = w->def.tolerance / (w->plan.history ? 32 : 1);
    double mean = w->mass / (double)w->nc, tau = (double)p->tau;
    double heavy = (double)p->stiffness * tau * tau / mean;
    double e = fmin(fmax(sqrt(heavy / 50), 1), 10);
    bool ends = is_last(s, asked);
    EXPECT(fabs((double)s->exact - exact_of(w, ends) * asked) <= 1e-5 * asked);
    double rough = ends ? asked : 0.3;
    EXPECT(fabs((double)s->tolerance - rough) <= 1e-5 * rough);
    double times = spy.turns == 0 ? 1 / (e * e) : ends ? e * e : 1;
    double was = spy.scale * times;
    EXPECT((s->last != NULL) == (spy.turns == 0 || ends));
    EXPECT(s->weigh == (spy.turns == 0));
    spy.soon += ends && spy.turns == 1;
    EXPECT(spy.scale == 0 || fabs((double)s->scale - was) <= 1e-5 * was);
    return NULL;
}

/* Stands in place of a joint solve: a motion before contact, a turn of the
 * contacts, or one in which friction follows. */
static int watch(struct world *w, struct joint *s)
{
    struct joint start = *s;
    size_t bytes = (size_t)s->nc * sizeof *s->r;
    bool turn = spy.turns < COUPLE_TURNS && (s->last || spy.turns > 0);
    if (spy.broken && !spy.failed && memcmp(s->r, spy.undone, bytes))
        spy.failed = "recall: what broke down is not left undone";
    if (turn && !spy.failed)
        spy.failed = check_care(w, s);
    if (turn && !spy.failed)
        spy.failed = solve_ways(w, &start);
    int status = spy.joint(w, s), end = spy.turns > 0;
    spy.scale = (double)s->scale;
    spy.square = (double)s->square;
    spy.turns = end && start.last ? (int)COUPLE_TURNS : spy.turns + turn;
    if (spy.turns == COUPLE_TURNS && !turn)
        spy.failed =
            w->couple.follows ? spy.failed : "recall: a turn too many (§4.3)";
    spy.broken = start.last && spy.spoils && end == 0;
    memcpy(spy.undone, s->b, bytes);
    if (!start.last)
        return status;
    spy.recalled++;
    if (spy.spoils && end == 0)
        s->outcome = PCG_BREAKDOWN;
    else if (spy.spoils)
        s->residual = (real)NAN;
    else
        memcpy(spy.found[end], s->dv, bytes);
    return status;
}

/* Two sheets come to lie on a slab. */
static const char *settle(int integrator, int precond, double stiff, int *soon,
                          int *hits)
{
    struct slab d;
    struct arena arena;
    drape_cloth cloth[2];
    slab_small(&d, integrator, 0.104);
    d.cloth.material.stretch *= stiff;
    cloth[0] = cloth[1] = d.cloth;
    cloth[1].origin[0] += 0.003;
    cloth[1].origin[1] += 0.004;
    d.obstacle.motion = -1;
    d.def.cloths = cloth;
    d.def.n_cloths = 2;
    d.def.precond = precond;
    d.def.max_slices = 1;
    struct world *w = slab_inner(&d.def, &arena);
    EXPECT(w);
    struct backend run = *w->run;
    spy = (struct spy){.joint = run.joint};
    run.joint = watch;
    w->run = &run;
    for (int k = 0; k < STEPS && !spy.failed; k++) {
        drape_step_report r;
        spy.turns = 0;
        spy.scale = 0;
        spy.spoils = k == STEPS - 1;
        EXPECT(step_advance(w, &r) == DRAPE_OK && r.slices == 1);
        EXPECT(spy.turns == 0 || spy.turns == COUPLE_TURNS);
        EXPECT(!spy.turns ||
               !memcmp(spy.found, w->solved,
                       sizeof(vec) * COUPLE_ENDS * (size_t)w->nc));
        ran(1);
    }
    EXPECT(spy.failed || spy.recalled >= STEPS);
    *soon += spy.soon;
    *hits += spy.hits;
    arena_free(&arena);
    return spy.failed;
}

const char *test_world_recall(void)
{
    static const int integrator[] = {DRAPE_BW, DRAPE_BDF2};
    const char *failed = NULL;
    int soon = 0, hits = 0;
    for (int k = 0; k < 4 && !failed; k++)
        failed =
            settle(integrator[k / 2], k % 2 ? DRAPE_MULTIGRID : DRAPE_JACOBI, 1,
                   &soon, &hits);
    /* contacts so heavy that e has its bound */
    if (!failed)
        failed = settle(DRAPE_BW, DRAPE_MULTIGRID, 10, &soon, &hits);
    EXPECT(failed || (soon > 0 && hits > 0));
    return failed;
}
