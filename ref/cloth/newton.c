/* SPDX-License-Identifier: Apache-2.0 */
/* The motion of an implicit integrator, on either backend.
 * spec/cloth/implicit.md */
#include "ref/cloth/newton.h"

#include "ref/cloth/force.h"

enum { CUTS = 4 }; /* of a step that overshoots, at most */
static const real OVERSHOT = R(0.5), LEAST_CUT = R(0.125), MOST_CUT = R(0.5);
static const real LATER = R(0.1);    /* tolerance of solves after the first */
static const real LONGEST = R(0.05); /* s, in shorter steps springs rotate */

/* The motion under way. */
struct motion {
    struct dynamics *s;
    const struct backend *run;
    struct gpu *on;
    int64_t past; /* count, or 0: the step is of backward Euler */
    real tau;
    const vec *from; /* [count] m/s, the velocity that dv is added to */
    int status;      /* the first that was not DRAPE_OK */
};

static void note_status(struct motion *a, int status)
{
    a->status = a->status == DRAPE_OK ? status : a->status;
}

static size_t bytes_of(const struct motion *a)
{
    return (size_t)a->s->cloth->count * sizeof(vec);
}

static void predict_motion(struct motion *a)
{
    struct dynamics *s = a->s;
    struct predict p = {.count = s->cloth->count,
                        .fixed = s->cloth->fixed,
                        .x = s->x,
                        .v = s->v,
                        .n_past = a->past,
                        .xp = s->xp,
                        .vp = s->vp,
                        .to = s->to,
                        .tau = a->tau,
                        .star = s->star,
                        .back = a->past ? s->back : NULL,
                        .q = a->past ? s->q : s->star};
    note_status(a, a->run->predict(a->on, &p));
    a->run->trace(a->on, a->s->trace, "predict", p.star, bytes_of(a));
}

/* Adds the force of the wind on the predicted motion, the same in each
 * iteration of Newton's method. The air's resistance to a change of the motion
 * is part of the matrix, as an inertia. */
static void add_wind(struct motion *a)
{
    struct wind w;
    if (!a->s->windy)
        return;
    force_wind(a->s, a->s->x, a->s->star, a->tau, &w);
    note_status(a, a->s->cloth->panel ? a->run->panel_wind(a->on, a->s, &w)
                                      : a->run->wind(a->on, &w));
    a->run->trace(a->on, a->s->trace, "wind", w.force, bytes_of(a));
}

static void add_springs(struct motion *a, const vec *x, const vec *damping)
{
    struct springs f;
    force_springs(a->s, x, damping, &f);
    if (a->s->met && x == a->s->x1) { /* springs.md §6: more exactly so */
        f.x = a->s->x;
        f.n_u = f.count;
        f.u = a->s->u;
        f.span = (real)a->s->dt;
    }
    note_status(a, a->run->springs(a->on, &f));
    a->run->trace(a->on, a->s->trace, "springs", f.force, bytes_of(a));
    if (!a->s->cloth->panel)
        return;
    note_status(a, a->run->panel_pull(a->on, a->s, &f));
    a->run->trace(a->on, a->s->trace, "pull", f.force, bytes_of(a));
}

/* The motion that the step predicts: q of implicit.md §1. */
static const vec *predicted_motion(const struct motion *a)
{
    return a->past ? a->s->q : a->s->star;
}

/* Whether the matrix has the directions of half way (blocks.md §8). */
static bool has_midway_directions(const struct motion *a)
{
    return !a->s->kept && a->s->at == a->s->x && a->tau < LONGEST;
}

/* The matrix at s->at. */
static void make_blocks(struct motion *a)
{
    struct dynamics *s = a->s;
    const struct cloth *c = s->cloth;
    struct blocks b = {.count = c->count,
                       .m = c->m,
                       .laws = SPRINGS,
                       .law = s->law,
                       .pieces = c->pieces,
                       .piece = s->piece,
                       .springs = c->springs,
                       .triples = c->triples,
                       .triple = s->triple,
                       .n_beside = c->triples ? c->count : 0,
                       .beside = c->beside,
                       .x = s->at,
                       .n_q = has_midway_directions(a) ? c->count : 0,
                       .q = predicted_motion(a),
                       .tau = a->tau,
                       .block = s->block,
                       .n_packed = s->packed ? SPRINGS * c->count : 0,
                       .packed = s->packed};
    size_t bytes = (size_t)(SPRINGS * c->count) * sizeof *b.block;
    note_status(a, a->run->motion_blocks(a->on, s, &b));
    a->run->trace(a->on, a->s->trace, "blocks", b.block, bytes);
    if (!c->panel)
        return;
    note_status(a, a->run->panel_joins(a->on, s, &b));
    a->run->trace(a->on, a->s->trace, "joins", b.block, bytes);
}

static void make_rhs(struct motion *a)
{
    struct dynamics *s = a->s;
    const struct cloth *c = s->cloth;
    struct rhs r = {.count = c->count,
                    .m = c->m,
                    .n = c->n,
                    .fixed = c->fixed,
                    .springs = cloth_pairs(c),
                    .n_blocks = SPRINGS * c->count,
                    .block = s->block,
                    .force = s->force,
                    .q = predicted_motion(a),
                    .tau = a->tau,
                    .b = s->b};
    note_status(a, a->run->rhs(a->on, &r));
    a->run->trace(a->on, a->s->trace, "rhs", r.b, bytes_of(a));
}

static void solve_system(struct motion *a, real tolerance)
{
    a->s->asked = tolerance;
    a->s->solves++;
    note_status(a, a->run->motion_solve(a->on, a->s));
    a->run->trace(a->on, a->s->trace, "pcg", a->s->dv, bytes_of(a));
}

static void update_motion(struct motion *a, real part)
{
    struct dynamics *s = a->s;
    struct update u = {.count = s->cloth->count,
                       .fixed = s->cloth->fixed,
                       .x = s->x,
                       .n_past = a->past,
                       .xp = s->xp,
                       .to = s->to,
                       .star = a->from,
                       .dv = s->dv,
                       .part = part,
                       .tau = a->tau,
                       .dt = (real)s->dt,
                       .x1 = s->x1,
                       .v1 = s->v1};
    note_status(a, a->run->update(a->on, &u));
    a->run->trace(a->on, a->s->trace, "update", u.v1, bytes_of(a));
}

/* b: what the motion x1, v1 leaves undone. */
static void find_imbalance(struct motion *a)
{
    struct dynamics *s = a->s;
    struct imbalance r = {.count = s->cloth->count,
                          .fixed = s->cloth->fixed,
                          .mass = dynamics_mass(s),
                          .force = s->force,
                          .v = s->v1,
                          .star = s->star,
                          .tau = a->tau,
                          .b = s->b};
    add_springs(a, s->x1, s->v1);
    note_status(a, a->run->imbalance(a->on, &r));
    a->run->trace(a->on, a->s->trace, "imbalance", r.b, bytes_of(a));
}

static real dot_streams(struct motion *a, const vec *left, const vec *right)
{
    int64_t n = a->s->cloth->count;
    struct dot d = {.n = n,
                    .a = left,
                    .b = right,
                    .n_chunks = sum_chunks(n),
                    .chunk = a->s->chunk};
    note_status(a, a->run->dot(a->on, &d));
    return d.value;
}

/* §6.2: takes dv, or a part of it, which is returned. `work` is b·dv of the
 * system that gave dv. A value that is no number fails the test, and cuts the
 * most. */
static real search_part(struct motion *a, real work)
{
    struct dynamics *s = a->s;
    real part = 1;
    for (int k = 0; k <= CUTS && a->status == DRAPE_OK; k++) {
        update_motion(a, part);
        find_imbalance(a);
        real left = dot_streams(a, s->b, s->dv);
        if (left >= -OVERSHOT * work || k == CUTS)
            break;
        real cut = work / (work - left);
        part *= cut > LEAST_CUT ? real_min(cut, MOST_CUT) : LEAST_CUT;
    }
    return part;
}

/* §6: Newton's method, from the first solve on. The last imbalance replaces the
 * velocities of the linearisation, which nothing reads any more. */
static void iterate_newton(struct motion *a, real tolerance)
{
    struct dynamics *s = a->s;
    vec *x = s->kept, *v = s->kept + s->cloth->count;
    real first = real_sqrt(dot_streams(a, s->b, s->b)), last = first, most = 0;
    solve_system(a, tolerance);
    while (a->status == DRAPE_OK) {
        real work = dot_streams(a, s->b, s->dv);
        most = s->solves == 1 ? work : most;
        bool small = search_part(a, work) == 1 && work <= tolerance * most;
        last = real_sqrt(dot_streams(a, s->b, s->b));
        if (s->solves >= s->newton || !(last > tolerance * first) || small)
            break;
        a->run->copy(a->on, x, s->x1, bytes_of(a));
        a->run->copy(a->on, v, s->v1, bytes_of(a));
        s->at = x;
        a->from = v;
        make_blocks(a);
        solve_system(a, real_max(tolerance, LATER));
    }
    s->residual = first > 0 ? (double)(last / first) : 0;
}

static struct motion motion_of(struct dynamics *s, const struct backend *run,
                               struct gpu *on)
{
    int64_t past =
        dynamics_second(s->method) && s->has_past ? s->cloth->count : 0;
    return (struct motion){.s = s,
                           .run = run,
                           .on = on,
                           .past = past,
                           .tau = (real)(past ? s->dt * 2 / 3 : s->dt),
                           .from = s->star};
}

int newton_open(struct dynamics *s, const struct backend *run, struct gpu *on)
{
    struct motion a = motion_of(s, run, on);
    s->substeps = 1;
    s->solves = 0;
    s->at = s->x;
    predict_motion(&a);
    add_wind(&a);
    add_springs(&a, s->x, a.past ? s->back : NULL);
    make_blocks(&a);
    make_rhs(&a);
    return a.status;
}

int newton_place(struct dynamics *s, const struct backend *run, struct gpu *on)
{
    struct motion a = motion_of(s, run, on);
    update_motion(&a, 0);
    return a.status;
}

int newton_balance(struct dynamics *s, const struct backend *run,
                   struct gpu *on)
{
    struct motion a = motion_of(s, run, on);
    find_imbalance(&a);
    return a.status;
}

int newton_linearise(struct dynamics *s, const struct backend *run,
                     struct gpu *on)
{
    struct motion a = motion_of(s, run, on);
    s->at = s->x1;
    make_blocks(&a);
    return a.status;
}

int newton_move(struct dynamics *s, const struct backend *run, struct gpu *on)
{
    struct motion a = motion_of(s, run, on);
    a.status = newton_open(s, run, on);
    if (s->kept) {
        iterate_newton(&a, s->tolerance);
        return a.status;
    }
    solve_system(&a, s->tolerance);
    if (a.status == DRAPE_OK)
        update_motion(&a, 1);
    return a.status;
}
