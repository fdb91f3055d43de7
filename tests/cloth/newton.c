/* SPDX-License-Identifier: Apache-2.0 */
/* Newton's method in a cloth's motion: it solves the equation of the step,
 * keeps a pendulum's swing, and gets through a buckle. spec/cloth/implicit.md
 * §6 */
#include "ref/cloth/newton.h"

#include <stdlib.h>

#include "tests/base/notes.h"
#include "tests/cloth/sheet.h"
#include "tests/world/scene.h"

enum { SIDE = 9, COUNT = SIDE * SIDE };

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

/* The mean angle of a sheet that hangs from y = z = 0. */
static double angle_of(const drape_world *world, double (*x)[3])
{
    double y = 0, z = 0;
    drape_read(world, x, NULL);
    for (int p = 0; p < COUNT; p++) {
        y += x[p][1];
        z += x[p][2];
    }
    return atan2(z, -y);
}

/* The share of its amplitude that a sheet of 1 m keeps from its first return to
 * its second, released at 0.3 rad, with steps of 1/60 s; *period in steps. -1:
 * a step was not clean. */
static double swing(int integrator, int newton, double *period)
{
    static double x[COUNT][3];
    drape_pin pin[SIDE];
    drape_def def;
    drape_cloth cloth;
    drape_world *world;
    drape_step_report report;
    drape_default(&def);
    drape_default_cloth(&cloth);
    for (int p = 0; p < COUNT; p++) {
        double along = (double)(p / SIDE) / (SIDE - 1);
        x[p][0] = (double)(p % SIDE) / (SIDE - 1);
        x[p][1] = -along * cos(0.3);
        x[p][2] = along * sin(0.3);
    }
    for (int i = 0; i < SIDE; i++)
        pin[i] = (drape_pin){i, 0, -1};
    cloth.m = cloth.n = SIDE;
    cloth.x = (const double(*)[3])x;
    cloth.pins = pin;
    cloth.n_pins = SIDE;
    cloth.material.damping = 0;
    cloth.material.stretch = 1e4;
    def.precision = REAL_BITS;
    def.integrator = integrator;
    def.newton = newton;
    def.self_collision = def.sleep = 0;
    def.cloths = &cloth;
    def.n_cloths = 1;
    if (drape_create(&def, &world, NULL) != DRAPE_OK)
        return -1;
    double angle[3] = {0}, peak[3] = {0}, when[3] = {0};
    int peaks = 0, bad = 0;
    for (int k = 0; k < 260 && peaks < 2 && !bad; k++) {
        bad = drape_step(world, &report) != DRAPE_OK || report.outcome;
        angle[0] = angle[1];
        angle[1] = angle[2];
        angle[2] = angle_of(world, x);
        if (k < 60 || angle[1] <= angle[0] || angle[1] < angle[2])
            continue;
        peak[peaks] = angle[1];
        when[peaks++] = k;
    }
    drape_destroy(world);
    *period = when[1] - when[0];
    return bad || peaks < 2 ? -1 : peak[1] / peak[0];
}

/* implicit.md, errata: backward Euler that is solved keeps what the formula
 * keeps of a harmonic motion, (1 + ω²h²)^(-1/2) a step; BDF2 hardly damps; one
 * system of either loses more. */
const char *test_newton_swings(void)
{
    double period, once;
    double euler = swing(DRAPE_BW, 8, &period), one = swing(DRAPE_BW, 1, &once);
    double turn = 2 * 3.14159265358979 / period;
    double formula = pow(1 + turn * turn, -period / 2);
    EXPECT(fabs(euler - formula) <= 0.015 && one < euler - 0.03);
    double second = swing(DRAPE_BDF2, 0, &period);
    one = swing(DRAPE_BDF2, 1, &once);
    EXPECT(second >= 0.97 && second <= 1 && one < second - 0.03);
    EXPECT(one == swing(DRAPE_CK, 0, &once));
    ran(5);
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

/* A strip of 5 cm × 1 cm with cells of 1 mm, held level by its short edge,
 * falls and buckles. Returns its slices in 20 steps of 1/60 s, or -1. */
static int drop_swatch(int integrator, int newton)
{
    drape_pin pin[11];
    drape_def def;
    drape_cloth cloth;
    drape_world *world;
    drape_step_report report;
    drape_default(&def);
    drape_default_cloth(&cloth);
    for (int j = 0; j < 11; j++)
        pin[j] = (drape_pin){0, j, -1};
    cloth.m = 51;
    cloth.n = 11;
    cloth.width = 0.05;
    cloth.height = 0.01;
    cloth.pins = pin;
    cloth.n_pins = 11;
    def.precision = REAL_BITS;
    def.integrator = integrator;
    def.newton = newton;
    def.cloths = &cloth;
    def.n_cloths = 1;
    if (drape_create(&def, &world, NULL) != DRAPE_OK)
        return -1;
    int slices = 0;
    for (int k = 0; k < 20; k++) {
        if (drape_step(world, &report) != DRAPE_OK || report.outcome)
            slices = -1000;
        slices += report.slices;
    }
    drape_destroy(world);
    return slices < 0 ? -1 : slices;
}

/* §6.2: what one system gets through in slices only, Newton's method takes in
 * whole steps. */
const char *test_newton_swatch(void)
{
    int one = drop_swatch(DRAPE_BW, 1), more = drop_swatch(DRAPE_BW, 5);
    EXPECT(one > 20 && more == 20);
    int second = drop_swatch(DRAPE_BDF2, 0);
    EXPECT(second > 0 && second <= one);
    ran(3);
    return NULL;
}

/* Steps a scene. Returns the hash of its end and of all stages; *m is its
 * memory. */
static uint64_t trail(int integrator, int newton, drape_memory *m)
{
    struct notes notes = {0};
    drape_def def;
    drape_cloth cloth;
    drape_world *world;
    drape_default(&def);
    drape_default_cloth(&cloth);
    cloth.m = cloth.n = 13;
    cloth.pins = (drape_pin[]){{0, 0, -1}};
    cloth.n_pins = 1;
    def.precision = REAL_BITS;
    def.integrator = integrator;
    def.newton = newton;
    def.cloths = &cloth;
    def.n_cloths = 1;
    def.trace = notes_take;
    def.trace_user = &notes;
    memset(m, 0, sizeof *m);
    if (drape_create(&def, &world, NULL) != DRAPE_OK)
        return 0;
    uint64_t hash = 0;
    for (int k = 0; k < 4; k++)
        hash |= drape_step(world, NULL) != DRAPE_OK;
    drape_count(world, m);
    hash = hash ? 0 : scene_hash(world);
    for (size_t k = 0; k < notes.n; k++)
        hash = hash * 31 + notes.note[k].digest;
    drape_destroy(world);
    notes_free(&notes);
    return hash;
}

/* §6.6: with one system all stages, bits and memory are as without Newton's
 * method; and BDF2 is then Choi–Ko. */
const char *test_newton_one(void)
{
    static const int same[3][2] = {
        {DRAPE_BW, DRAPE_BW}, {DRAPE_CK, DRAPE_CK}, {DRAPE_CK, DRAPE_BDF2}};
    for (int k = 0; k < 3; k++) {
        drape_memory a, b;
        uint64_t none = trail(same[k][0], 0, &a);
        uint64_t one = trail(same[k][1], 1, &b);
        EXPECT(none && none == one && a.host_bytes == b.host_bytes);
        uint64_t two = trail(same[k][1], 2, &b);
        EXPECT(two && none != two && a.host_bytes < b.host_bytes);
        ran(1);
    }
    return NULL;
}
