/* SPDX-License-Identifier: Apache-2.0 */
/* After the solves of a step its whole linear system holds up to the residual
 * that the step reports. spec/contact/penalty.md §4.1 */
#include "ref/base/wide.h"
#include "ref/world/state.h"
#include "ref/world/step.h"
#include "tests/solve/system.h"
#include "tests/world/slab.h"

enum { SIDE = 12, COUNT = SIDE * SIDE };

/* Sums over the solves of one cloth in a step; with Newton's method the dv of
 * the contacts' solves alone, as the imbalance that is left has taken the
 * others. */
struct ledger {
    struct world *w;
    int solves;
    double first, most;    /* |r| after the first solve; the largest |b| */
    struct wide dv[COUNT]; /* Σ dv */
    double way[COUNT];     /* Σ |dv| */
    double size;           /* Σ |b| + |A + hold| |dv| */
    vec pressed[COUNT];    /* N·s, dt · press of the slice before */
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

/* A drape_trace that adds each solve to the ledger. */
static void add_solve(void *user, int64_t step, const char *stage,
                      uint64_t digest, double seconds)
{
    struct ledger *a = user;
    const struct pcg *p = &a->w->sheet[0].solver.pcg;
    double square = 0;
    (void)step;
    (void)digest;
    (void)seconds;
    if (strcmp(stage, "pcg"))
        return;
    bool counts = p->n_extra || a->w->def.newton <= 1;
    if (!p->n_extra)
        *a = (struct ledger){
            .w = a->w, .solves = a->solves, .first = a->first, .most = a->most};
    for (int k = 0; k < COUNT && !p->n_extra; k++)
        a->pressed[k] = vec_scale((real)a->w->dt, a->w->press[k]);
    for (int k = 0; k < COUNT; k++) {
        struct wide b = wide_of(p->b[k]), dv = wide_of(p->dv[k]);
        double hold = p->n_extra ? trace_of(p->extra[k]) : 0;
        a->dv[k] = wide_axpy(a->dv[k], counts, dv);
        a->way[k] += counts ? length(dv) : 0;
        a->size += length(b) + hold * length(dv);
        a->size += p->n_extra ? 0 : length(wide_of(a->pressed[k]));
        square += wide_dot(b, b);
    }
    a->most = fmax(a->most, sqrt(square));
    if (a->solves++ == 0)
        a->first = (double)p->residual * sqrt(square);
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

/* |b - pressed + force - A Σ dv - hold dv|, with force, hold and dv of the last
 * turn: b, by Newton's method the imbalance that is left, includes `pressed`,
 * which `force` replaces. */
static double left_over(struct ledger *a)
{
    const struct sheet *s = &a->w->sheet[0];
    const struct couple *c = &a->w->couple;
    const vec *b = s->dynamics.left ? s->dynamics.left : s->dynamics.b;
    struct wide r[COUNT];
    double square = 0;
    for (int k = 0; k < COUNT; k++) {
        double m = (double)s->cloth.mass[k];
        r[k] = wide_axpy(wide_of(b[k]), -m, a->dv[k]);
        r[k] = wide_axpy(r[k], -1, wide_of(a->pressed[k]));
        r[k] = wide_axpy(r[k], 1, wide_of(c->penalty.force[k]));
        r[k] = less(r[k], c->penalty.hold[k], wide_of(c->dv[k]));
        a->size += m * a->way[k] + length(wide_of(b[k]));
    }
    for (int k = 0; k < SPRINGS * COUNT; k++) {
        int o = k / COUNT, p = k % COUNT, q = p + (int)spring_step(SIDE, o);
        sym block = s->dynamics.block[k];
        if (!(s->cloth.springs[p] >> o & 1))
            continue;
        r[p] = less(r[p], block, wide_sub(a->dv[p], a->dv[q]));
        r[q] = less(r[q], block, wide_sub(a->dv[q], a->dv[p]));
        a->size += 2 * trace_of(block) * (a->way[p] + a->way[q]);
    }
    for (int k = 0; k < COUNT; k++)
        square += wide_dot(r[k], r[k]);
    return sqrt(square);
}

/* left_over is the reported residual up to rounding, as before the last turn
 * g = pressed + A Σ dv - b. |r|, |g| and each A dv are at most `size`. A solve
 * rounds b, r, dv, b - r, hold dv (3), A dv and the report: 9 u of its part;
 * and g: u of the sum. The chains in binary64, in the residual and here, have
 * at most 40 + 60 + solves roundings. */
static const char *balance(struct ledger *a, const drape_step_report *r)
{
    double left = left_over(a), told = r->residual * a->most;
    double u = REAL_BITS == 32 ? 0x1p-24 : 0x1p-53;
    double error = (9 + a->solves) * u + (100 + a->solves) * 0x1p-53;
    EXPECT(r->outcome == 0 && r->residual <= 1e-3);
    EXPECT(a->solves == r->work.solves && a->solves > 1);
    EXPECT(fabs(left - told) <= error * a->size);
    return NULL;
}

/* Steps a disordered sheet near a slab; up: step 1 has no contacts any more. */
static const char *run(bool up, int precond, int newton)
{
    static double v[COUNT][3];
    struct slab d;
    struct arena arena;
    struct ledger a = {0};
    drape_error error;
    const char *failed = NULL;
    for (uint64_t k = 0; k < 3 * COUNT; k++)
        v[k / 3][k % 3] = 0.5 * noise_of(k) + (up && k % 3 == 1 ? 2 : 0);
    slab_make(&d, DRAPE_BW);
    d.cloth.m = d.cloth.n = SIDE;
    d.cloth.width = d.cloth.height = 0.22;
    d.cloth.origin[0] = d.cloth.origin[2] = -0.11;
    d.cloth.origin[1] = 0.103;
    d.cloth.velocity = (const double(*)[3])v;
    d.obstacle.motion = -1;
    d.def.precond = precond;
    d.def.newton = newton;
    d.def.max_slices = 1;
    d.def.trace = add_solve;
    d.def.trace_user = &a;
    arena_init(&arena, &d.def.allocator);
    EXPECT(world_make(&d.def, &arena, &a.w, &error) == DRAPE_OK);
    for (int k = 0; k < 4 && !failed; k++) {
        drape_step_report r;
        a = (struct ledger){.w = a.w};
        EXPECT(step_advance(a.w, &r) == DRAPE_OK);
        EXPECT((r.contacts == 0) == (up && k > 0));
        EXPECT(a.w->couple.rough == (k == 1 || (!up && k > 1)));
        failed = a.w->couple.rough ? balance(&a, &r) : NULL;
        EXPECT(k != 1 || a.first > 2e-3 * a.most); /* it was solved roughly */
    }
    arena_free(&arena);
    ran(1);
    return failed;
}

const char *test_world_rough(void)
{
    const char *failed = NULL;
    for (int k = 0; k < 8 && !failed; k++)
        failed = run(k % 2, k / 2 % 2 ? DRAPE_MULTIGRID : DRAPE_JACOBI,
                     k / 4 ? 4 : 1);
    return failed;
}
