/* SPDX-License-Identifier: Apache-2.0 */
/* After the loop of a slice its whole system holds up to the residual that the
 * step reports. spec/contact/lagrange.md §3 */
#include "ref/base/wide.h"
#include "ref/world/state.h"
#include "ref/world/step.h"
#include "tests/solve/system.h"
#include "tests/world/slab.h"

enum { SIDE = 12, COUNT = SIDE * SIDE };

/* Where the system was last made or measured: b at the velocities v. */
struct ledger {
    struct world *w;
    vec b[COUNT], v[COUNT]; /* N·s, m/s */
    double size;            /* Σ |b| + |A| |v1 - v| */
};

static double length(struct wide a)
{
    return sqrt(wide_dot(a, a));
}

/* The trace of a: an upper bound of its norm, as a is positive semidefinite. */
static double trace_of(sym a)
{
    return (double)a.xx + (double)a.yy + (double)a.zz;
}

/* r - a d. */
static struct wide less(struct wide r, sym a, struct wide d)
{
    struct wide x = {(double)a.xx, (double)a.xy, (double)a.xz};
    struct wide y = {(double)a.xy, (double)a.yy, (double)a.yz};
    struct wide z = {(double)a.xz, (double)a.yz, (double)a.zz};
    return wide_make(r.x - wide_dot(x, d), r.y - wide_dot(y, d),
                     r.z - wide_dot(z, d));
}

/* A drape_trace that keeps the last b. */
static void listen(void *user, int64_t step, const char *stage, uint64_t digest,
                   double seconds)
{
    struct ledger *a = user;
    (void)step;
    (void)digest;
    (void)seconds;
    if (!a->w) /* the world is being made */
        return;
    const struct dynamics *d = &a->w->sheet[0].dynamics;
    bool made = !strcmp(stage, "rhs");
    if (!made && strcmp(stage, "imbalance"))
        return;
    memcpy(a->b, d->b, sizeof a->b);
    memcpy(a->v, made ? d->star : d->v1, sizeof a->v);
}

/* §3.1: what the cloth's own motion leaves undone at the end, b - A (v1 - v) by
 * binary64. */
static void find_rest(struct ledger *a, struct wide r[COUNT])
{
    const struct sheet *s = &a->w->sheet[0];
    struct wide dv[COUNT];
    a->size = 0;
    for (int k = 0; k < COUNT; k++) { /* the step has swapped v0 and v1 */
        double m = (double)s->cloth.mass[k];
        dv[k] = wide_sub(wide_of(a->w->v0[k]), wide_of(a->v[k]));
        r[k] = wide_axpy(wide_of(a->b[k]), -m, dv[k]);
        double way = length(wide_of(a->w->v0[k])) + length(wide_of(a->v[k]));
        a->size += length(wide_of(a->b[k])) + m * way;
    }
    for (int k = 0; k < SPRINGS * COUNT; k++) {
        int o = k / COUNT, p = k % COUNT, q = p + (int)spring_step(SIDE, o);
        sym block = s->dynamics.block[k];
        if (!(s->cloth.springs[p] >> o & 1))
            continue;
        struct wide d = wide_sub(dv[p], dv[q]);
        r[p] = less(r[p], block, d);
        r[q] = less(r[q], block, wide_scale(-1, d));
        double way = length(wide_of(a->w->v0[p])) + length(wide_of(a->v[p])) +
                     length(wide_of(a->w->v0[q])) + length(wide_of(a->v[q]));
        a->size += 4 * trace_of(block) * way;
    }
}

/* The residual that the loop kept up is that of the velocities that it gives,
 * up to rounding: 64 u for A dv (product.md, any form) and a few of b and r in
 * each of at most 24 solves with 13 moves each. Contacts' forces and the
 * residual follow from it. */
static const char *balance(struct ledger *a)
{
    const struct lagrange *l = &a->w->lagrange;
    struct wide r[COUNT];
    double u = REAL_BITS == 32 ? 0x1p-24 : 0x1p-53;
    find_rest(a, r);
    for (int k = 0; k < COUNT; k++) {
        double off = length(wide_sub(wide_of(l->rest[k]), r[k]));
        EXPECT(off <= 400 * u * a->size);
        vec inner = vec_add(l->rest[k], l->law.force[k]);
        EXPECT(!memcmp(&inner, &l->law.inner[k], sizeof inner));
    }
    return NULL;
}

/* §3.4: what is left is at most the tolerance, in the energy norm, of what the
 * net forces of contacts, gravity and the first residual are. The energy norm
 * of an impulse r is at most that of free masses, Σ r² w: if even that is small
 * the report has to be. */
static const char *check_residual(const struct ledger *a,
                                  const drape_step_report *r)
{
    const struct lagrange *l = &a->w->lagrange;
    double free_norm = 0, mass = 0;
    for (int k = 0; k < COUNT; k++) {
        double w = (double)a->w->w[k];
        free_norm += w * (double)vec_dot(l->law.outer[k], l->law.outer[k]);
        mass += w > 0 ? 1 / w : 0;
    }
    double least = sqrt(mass) * 9.81 * a->w->dt;
    EXPECT(r->residual >= l->residual && l->residual >= 0);
    EXPECT(r->residual == l->residual || !l->begun); /* of the motion before */
    EXPECT(l->residual * least <= 1.01 * sqrt(free_norm));
    return NULL;
}

/* A disordered sheet just above a slab, whose particles rise at `up`, m/s. */
static void disorder(struct slab *d, double v[COUNT][3], double up, int precond)
{
    for (uint64_t k = 0; k < 3 * COUNT; k++)
        v[k / 3][k % 3] = 0.1 * noise_of(k) + (k % 3 == 1 ? up : 0);
    slab_make(d, DRAPE_BW);
    d->cloth.m = d->cloth.n = SIDE;
    d->cloth.width = d->cloth.height = 0.22;
    d->cloth.origin[0] = d->cloth.origin[2] = -0.11;
    d->cloth.origin[1] = 0.103;
    d->cloth.velocity = (const double(*)[3])v;
    d->obstacle.motion = -1;
    d->def.precond = precond;
}

/* Steps a disordered sheet near a slab; up: step 1 has no contacts any more.
 * The disorder is less than a cell in a step. Its impact may end by the looser
 * rule of Newton's part (lagrange.md §4); from then on all slices end in
 * balance. */
static const char *run(bool up, int precond, int newton)
{
    static double v[COUNT][3];
    struct slab d;
    struct arena arena;
    static struct ledger a;
    drape_error error;
    const char *failed = NULL;
    a = (struct ledger){0};
    disorder(&d, v, up ? 2 : 0, precond);
    d.def.newton = newton;
    d.def.max_slices = 1;
    d.def.trace = listen;
    d.def.trace_user = &a;
    arena_init(&arena, &d.def.allocator);
    EXPECT(world_make(&d.def, &arena, &a.w, &error) == DRAPE_OK);
    for (int k = 0; k < 8 && !failed; k++) {
        drape_step_report r;
        EXPECT(step_advance(a.w, &r) == DRAPE_OK);
        EXPECT((r.contacts == 0) == (up && k > 0));
        EXPECT(a.w->lagrange.solved || r.contacts == 0);
        if (!a.w->lagrange.solved)
            continue;
        failed = r.rounds <= 1 ? balance(&a) : NULL;
        failed = failed ? failed : check_residual(&a, &r);
        EXPECT(r.residual <= 1e-3 || k == 0);
    }
    arena_free(&arena);
    ran(1);
    return failed;
}

/* The tolerance holds at the end of a slice, too, where contacts have next to
 * nothing to push: a sheet falls along a slab, with its mesh in motion. */
static const char *glide(int precond)
{
    static double v[COUNT][3];
    struct slab d;
    struct arena arena;
    drape_step_report r;
    const char *failed = NULL;
    int met = 0;
    for (uint64_t k = 0; k < COUNT; k++) {
        v[k][0] = 0.5 * noise_of(2 * k);
        v[k][2] = 0.5 * noise_of(2 * k + 1);
    }
    slab_make(&d, DRAPE_BW);
    d.cloth.m = d.cloth.n = SIDE;
    d.cloth.width = d.cloth.height = 0.11;
    d.cloth.origin[0] = d.cloth.origin[2] = -0.055;
    d.cloth.origin[1] = 0.10399;
    d.cloth.velocity = (const double(*)[3])v;
    d.cloth.material.friction = d.obstacle.friction = 0;
    d.obstacle.motion = -1;
    d.def.precond = precond;
    d.def.gravity[0] = 9.81;
    d.def.gravity[1] = 0;
    struct world *w = slab_inner(&d.def, &arena);
    EXPECT(w);
    for (int k = 0; k < 4 && !failed; k++) {
        if (step_advance(w, &r) != DRAPE_OK || r.outcome != 0)
            failed = "glide: a step fails";
        else if (!(r.residual <= 1e-3))
            failed = "glide: the tolerance does not hold (lagrange.md §3.4)";
        met += r.contacts > 0 && w->lagrange.solved;
    }
    arena_free(&arena);
    EXPECT(failed || met > 0);
    ran(1);
    return failed;
}

/* However loose the tolerance is, a slice leaves at most a fifth of what the
 * cloths carry: √(Σ m v²) of its start, or what gravity does. The residual
 * is relative to a scale that is no less than the latter (§3.4). */
static const char *loose(int precond)
{
    static double v[COUNT][3];
    struct slab d;
    struct arena arena;
    drape_step_report r;
    const char *failed = NULL;
    disorder(&d, v, 0, precond);
    d.def.tolerance = 0.1;
    struct world *w = slab_inner(&d.def, &arena);
    EXPECT(w);
    for (int k = 0; k < 8 && !failed; k++) {
        double sum = 0, mass = 0;
        for (int p = 0; p < COUNT; p++) {
            double m = 1 / (double)w->w[p];
            sum += m * (double)vec_dot(w->v0[p], w->v0[p]);
            mass += m;
        }
        double least = sqrt(mass) * 9.81 * w->dt;
        if (step_advance(w, &r) != DRAPE_OK)
            failed = "loose: a step fails";
        else if (w->lagrange.solved &&
                 w->lagrange.residual * least > 0.2001 * fmax(sqrt(sum), least))
            failed = "loose: a slice leaves too much (lagrange.md §3.4)";
    }
    arena_free(&arena);
    ran(1);
    return failed;
}

const char *test_lagrange_balance(void)
{
    const char *failed = NULL;
    for (int k = 0; k < 8 && !failed; k++)
        failed = run(k % 2, k / 2 % 2 ? DRAPE_MULTIGRID : DRAPE_JACOBI,
                     k / 4 ? 4 : 1);
    for (int k = 0; k < 2 && !failed; k++)
        failed = glide(k ? DRAPE_MULTIGRID : DRAPE_JACOBI);
    for (int k = 0; k < 2 && !failed; k++)
        failed = loose(k ? DRAPE_MULTIGRID : DRAPE_JACOBI);
    return failed;
}
