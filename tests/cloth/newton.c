/* SPDX-License-Identifier: Apache-2.0 */
/* Newton's method in a cloth's motion: it solves the equation of the step,
 * keeps a pendulum's swing, and gets through a buckle. spec/cloth/implicit.md
 * §6 */
#include "ref/cloth/newton.h"

#include <stdlib.h>

#include "tests/cloth/sheet.h"

/* Root of Σ |τ (f(x1, v1)) − M (v1 − v̂)|² where free, in binary64 but for the
 * forces themselves. */
static double left_over(struct sheet *s)
{
    const struct dynamics *d = &s->d;
    bool past = dynamics_second(d->method) && d->has_past;
    double sum = 0, tau = past ? d->dt * 2 / 3 : d->dt;
    vec *f = s->to; /* nothing is pinned */
    sheet_force(s, d->x1, d->v1, f);
    for (int64_t k = 0; k < 3 * s->c.count; k++) {
        double v0 = (double)(&s->v[k / 3].x)[k % 3];
        double vp = (double)(&s->vp[k / 3].x)[k % 3];
        double star = past ? v0 + (v0 - vp) / 3 : v0;
        double gain = (double)(&d->v1[k / 3].x)[k % 3] - star;
        double r = tau * (double)(&f[k / 3].x)[k % 3] -
                   (double)s->c.mass[k / 3] * gain;
        sum += r * r;
    }
    return sqrt(sum);
}

/* A free sheet out of its plane by up to `noise` m, which moves at random. */
static int make_crumpled(struct sheet *s, int method, int seed, double noise)
{
    drape_cloth d = sheet_default(7, 7);
    uint32_t random = (uint32_t)seed;
    d.material.damping = seed % 2 ? 1e-3 : 0;
    int status = sheet_make(s, &d, method);
    for (int64_t k = 0; k < 3 * s->c.count; k++) {
        random = random * 1664525 + 1013904223;
        double x = (random >> 8) * 0x1p-23 - 1;
        (&s->x[k / 3].x)[k % 3] += (real)(noise * x);
        (&s->v[k / 3].x)[k % 3] = (real)(k % 5 * x);
    }
    s->d.gravity = vec_make(0, R(-9.81), 0);
    return status;
}

/* Steps a sheet by a method with up to `newton` systems. *left: the most that a
 * step leaves undone, N·s. */
static const char *leave(int method, int seed, int newton, double *left)
{
    struct sheet s;
    *left = 0;
    EXPECT(make_crumpled(&s, method, seed, 0.02) == DRAPE_OK);
    vec *kept = calloc((size_t)s.c.count * 2, sizeof *kept);
    EXPECT(kept);
    s.d.kept = newton > 1 ? kept : NULL;
    s.d.newton = newton;
    s.d.tolerance = REAL_BITS == 32 ? R(1e-9) : R(1e-13);
    const char *what = NULL;
    for (int k = 0; k < 3 && !what; k++) {
        struct sheet start = s;
        vec v[49], vp[49];
        memcpy(v, s.v, sizeof v);
        memcpy(vp, s.vp, sizeof vp);
        if (sheet_step(&s) != DRAPE_OK || s.d.outcome)
            what = "a step failed";
        start.v = v;
        start.vp = vp;
        if (k > 0) /* with a past */
            *left = fmax(*left, left_over(&start));
        if (s.d.solves > newton)
            what = "more systems than allowed";
    }
    free(kept);
    sheet_free(&s);
    return what;
}

/* §6.1, §6.3: what a step of a crumpled sheet leaves undone falls as far as the
 * tolerance or rounding lets it, by each implicit method; one system leaves a
 * hundred times as much at least. */
const char *test_newton_solves(void)
{
    double few = REAL_BITS == 32 ? 4e-6 : 2e-8;
    for (int method = DRAPE_BW; method <= DRAPE_BDF2; method++)
        for (int seed = 1; seed <= 6; seed++) {
            double one, all;
            const char *what = leave(method, seed, 1, &one);
            what = what ? what : leave(method, seed, 64, &all);
            if (what)
                return what;
            EXPECT(all <= few && one >= 100 * few);
            ran(1);
        }
    return NULL;
}

/* Spins a sheet of its own in its plane for 0.1 s in `steps` steps; *to is
 * where it ends. */
static const char *spin(int method, int steps, double damping, struct sheet *s)
{
    drape_cloth d = sheet_default(5, 5);
    d.material.damping = damping;
    EXPECT(sheet_make(s, &d, method) == DRAPE_OK);
    for (int64_t p = 0; p < s->c.count; p++) {
        vec from = vec_sub(s->x[p], vec_make(R(0.5), R(0.5), 0));
        s->v[p] = vec_make(-10 * from.y, 10 * from.x, 0);
    }
    s->d.dt = 0.1 / steps;
    for (int k = 0; k < steps; k++)
        EXPECT(sheet_step(s) == DRAPE_OK && !s->d.outcome);
    return NULL;
}

static double distance(const struct sheet *a, const struct sheet *b)
{
    double sum = 0;
    for (int64_t p = 0; p < a->c.count; p++) {
        vec d = vec_sub(a->x[p], b->x[p]);
        sum += (double)vec_dot(d, d);
    }
    return sqrt(sum);
}

/* §5: in rotation BDF2 has order 2, damped or not. */
const char *test_newton_order(void)
{
    if (REAL_BITS == 32)
        return skip("rounding hides the order: binary64 decides");
    for (int damped = 0; damped < 2; damped++) {
        struct sheet exact, s;
        double error[2], beta = damped * 1e-3;
        const char *what = spin(DRAPE_RK4, 2048, beta, &exact);
        for (int k = 0; k < 2 && !what; k++) {
            what = spin(DRAPE_BDF2, 64 << k, beta, &s);
            error[k] = distance(&s, &exact);
            sheet_free(&s);
        }
        sheet_free(&exact);
        if (what)
            return what;
        EXPECT(fabs(log2(error[0] / error[1]) - 2) <= 0.15);
        ran(1);
    }
    return NULL;
}
