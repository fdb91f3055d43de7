/* SPDX-License-Identifier: Apache-2.0 */
/* Whole worlds obey mechanics: their masses, free fall, the momentum of sheets
 * that meet, wind and prescribed frames. spec/world/step.md */
#include <stdlib.h>

#include "ref/broad/box.h"
#include "ref/control/control.h"
#include "ref/world/state.h"
#include "ref/world/step.h"
#include "tests/solve/system.h"
#include "tests/world/scene.h"
#include "tests/world/slab.h"

enum { SIDE = 12, COUNT = SIDE * SIDE };
static const int methods[] = {DRAPE_EULER, DRAPE_VERLET, DRAPE_BW, DRAPE_CK};
enum { METHODS = 4 };

/* Makes a sheet of 0.25 m, high above a slab that does not move. */
static void make_small(struct slab *d, int integrator)
{
    slab_make(d, integrator);
    d->def.dt = integrator < DRAPE_BW ? 0x1p-12 : 0x1p-6;
    d->obstacle.motion = -1;
    d->cloth.m = d->cloth.n = SIDE;
    d->cloth.width = d->cloth.height = 0.25;
    d->cloth.origin[1] = 8;
}

/* Making a world */

static void make_mixed(struct slab *d, drape_cloth cloth[2],
                       drape_obstacle obstacle[2])
{
    static const drape_pin pin = {1, 2, -1};
    make_small(d, DRAPE_BW);
    for (int k = 0; k < 2; k++) {
        cloth[k] = d->cloth;
        obstacle[k] = d->obstacle;
        cloth[k].origin[1] += k;
        cloth[k].m = SIDE + k;
        cloth[k].material.density = 0.25 + k;
        cloth[k].material.stretch = 500 + 300 * k;
        cloth[k].material.friction = 0.25 + 0.125 * k;
        cloth[k].material.thickness = k ? 1 : 0.00390625;
        obstacle[k].friction = 0.5 + 0.125 * k;
    }
    cloth[1].pins = &pin;
    cloth[1].n_pins = 1;
    d->def.cloths = cloth;
    d->def.obstacles = obstacle;
    d->def.n_cloths = d->def.n_obstacles = 2;
}

static bool near(double a, double b)
{
    return fabs(a - b) <= 1e-6 * fabs(b);
}

/* Each body has a surface of its own, with a thickness of at most half a cell;
 * prescribed vertices have inverse mass 0. */
const char *test_world_made(void)
{
    struct slab d;
    struct arena arena;
    drape_cloth cloth[2];
    drape_obstacle obstacle[2];
    make_mixed(&d, cloth, obstacle);
    struct world *w = slab_inner(&d.def, &arena);
    EXPECT(w && w->nc == COUNT + COUNT + SIDE && w->nv == w->nc + 16);
    double side = 0.25 / SIDE, mass = 0; /* of the second cloth's cells */
    EXPECT(near((double)w->cell, side));
    EXPECT(near((double)w->surface[0].thickness, 0.00390625));
    EXPECT(near((double)w->surface[1].thickness, side / 2));
    EXPECT(near((double)w->reach, side / 2) &&
           w->response.stiffness == R(0.1) * 800);
    for (int k = 0; k < 2; k++) {
        EXPECT(w->surface[k].friction == (real)cloth[k].material.friction);
        EXPECT(w->surface[2 + k].friction == (real)obstacle[k].friction);
        EXPECT(w->surface[2 + k].thickness == 0);
        mass += 0.0625 * cloth[k].material.density;
    }
    EXPECT(near(w->mass, mass));
    int64_t held = w->sheet[1].first + 1 + 2 * (SIDE + 1);
    for (int64_t i = 0; i < w->nv; i++) {
        int body = i < COUNT ? 0 : i < w->nc ? 1 : i < w->nc + 8 ? 2 : 3;
        EXPECT(w->body[i] == body);
        EXPECT((w->w[i] == 0) == (body >= 2 || i == held));
        mass -= w->w[i] > 0 ? 1 / (double)w->w[i] : 0;
    }
    double one = 0.0625 * 1.25 / (SIDE * (SIDE - 1)); /* of the held vertex */
    EXPECT(fabs(mass - one) <= 1e-6 * w->mass);
    arena_free(&arena);
    ran(1);
    return NULL;
}

/* Motions that diverge before one does not. */
static int diverging;

static int diverge(struct gpu *on, struct sheet *s)
{
    int status = backend_ref.motion(on, s);
    s->dynamics.outcome |= diverging-- > 0 ? DRAPE_DIVERGED : 0;
    return status;
}

/* A sheet in free fall has v = g t exactly with every integrator, with Choi–Ko
 * also where slices change length. */
static const char *check_fall(int integrator)
{
    struct slab d;
    struct arena arena;
    drape_step_report r;
    make_small(&d, integrator);
    d.cloth.width = d.cloth.height = (SIDE - 1) / 64.0; /* no rounding */
    d.def.tolerance = 1e-6;
    struct world *w = slab_inner(&d.def, &arena);
    EXPECT(w);
    struct backend run = *w->run;
    run.motion = diverge;
    w->run = &run;
    double mass = 0.2 * d.cloth.width * d.cloth.height;
    for (int step = 0; step < 16; step++) {
        diverging = step % 4 == 1 || step % 4 == 2;
        EXPECT(step_advance(w, &r) == DRAPE_OK && r.outcome == 0);
        EXPECT(r.time == r.step * d.def.dt && r.step == step + 1);
        EXPECT(r.slices == 1 + (step % 4 == 1 || step % 4 == 2));
        double y = 0, speed = 9.81 * r.time;
        for (int64_t i = 0; i < w->nc; i++) {
            EXPECT(fabs((double)w->v0[i].y + speed) <= 1e-5 * speed);
            y += 9.81 * (double)w->x0[i].y / (double)w->w[i];
        }
        double kinetic = mass * speed * speed / 2;
        EXPECT(fabs(r.kinetic - kinetic) <= 1e-4 * kinetic);
        EXPECT(fabs(r.potential - y) <= 1e-5 * y);
        EXPECT(r.elastic >= 0 && r.elastic <= 1e-6);
        ran(1);
    }
    arena_free(&arena);
    return NULL;
}

const char *test_world_free_fall(void)
{
    const char *failed = NULL;
    for (int k = 0; k < METHODS && !failed; k++)
        failed = check_fall(methods[k]);
    return failed;
}

/* Two sheets that meet */

static double kinetic(const struct world *w)
{
    double sum = 0;
    for (int64_t i = 0; i < w->nc; i++)
        sum += (double)vec_dot(w->v0[i], w->v0[i]) / (2 * (double)w->w[i]);
    return sum;
}

static void momentum(const struct world *w, double p[3], double *size)
{
    memset(p, 0, 3 * sizeof *p);
    *size = 0;
    for (int64_t i = 0; i < w->nc; i++) {
        double m = 1 / (double)w->w[i];
        p[0] += m * (double)w->v0[i].x;
        p[1] += m * (double)w->v0[i].y;
        p[2] += m * (double)w->v0[i].z;
        *size += m * (double)vec_length(w->v0[i]);
    }
}

/* How two sheets meet: the second has `heavy` times the density of the first.
 * `lost`: which part of the momentum may be lost. */
struct meeting {
    int integrator, obstacles;
    double heavy, tolerance, lost;
};

/* Two sheets that meet keep their momentum, friction included, and gain no
 * energy. */
static const char *check_meeting(const struct meeting *a)
{
    static double v[2][COUNT][3];
    drape_cloth cloth[2];
    struct slab d;
    struct arena arena;
    drape_step_report r;
    double before[3], after[3], size;
    bool implicit = a->integrator >= DRAPE_BW;
    int64_t contacts = 0;
    make_small(&d, a->integrator);
    for (int k = 0; k < 2; k++) {
        cloth[k] = d.cloth;
        cloth[k].material.density = k ? 0.2 * a->heavy : 0.2;
        cloth[k].origin[1] = 8 + 0.006 * k;
        cloth[k].velocity = (const double(*)[3])v[k];
        for (int p = 0; p < COUNT; p++) {
            v[k][p][0] = 0.3 * k;
            v[k][p][1] = (k ? -1 : 0.5) + 0.05 * noise_of((uint64_t)p);
        }
    }
    d.def.gravity[1] = 0;
    d.def.tolerance = a->tolerance;
    d.def.n_obstacles = a->obstacles;
    d.def.cloths = cloth;
    d.def.n_cloths = 2;
    struct world *w = slab_inner(&d.def, &arena);
    EXPECT(w);
    double first = kinetic(w);
    momentum(w, before, &size);
    for (int step = 0; step < (implicit ? 10 : 40); step++) {
        EXPECT(step_advance(w, &r) == DRAPE_OK);
        EXPECT(!(r.outcome & (DRAPE_TRAPPED | DRAPE_DIVERGED)));
        momentum(w, after, &size);
        for (int i = 0; i < 3; i++)
            EXPECT(fabs(after[i] - before[i]) <= a->lost * size);
        EXPECT(r.kinetic + r.elastic <= 1.001 * first);
        contacts += r.contacts;
        ran(1);
    }
    EXPECT(contacts > 0 && r.kinetic < (1 - 0.1 / a->heavy) * first);
    arena_free(&arena);
    return NULL;
}

/* The implicit solve loses as much momentum as its tolerance allows: at most
 * 0.22 % in these cases. */
const char *test_world_momentum(void)
{
    const char *failed = NULL;
    for (int k = 0; k < METHODS && !failed; k++) {
        struct meeting a = {methods[k], 1, 1.5, 1e-5,
                            methods[k] < DRAPE_BW ? 1e-5 : 3e-3};
        failed = check_meeting(&a);
    }
    return failed;
}

/* momentum.md §3: where nothing but cloths can act on cloths, almost none is
 * lost even at the default tolerance, at any ratio of the masses. */
const char *test_world_balance(void)
{
    const double heavy[] = {1, 10, 100};
    const char *failed = NULL;
    for (int k = 0; k < 3 && !failed; k++) {
        struct meeting a = {DRAPE_BW, 0, heavy[k], 1e-3, 1e-3};
        failed = check_meeting(&a);
    }
    return failed;
}

/* wind.md §1: the momentum that a wind of 2 m/s upwards gives a tilted plate at
 * rest in a first short step. The wind is set in the definition, or later. */
static const char *check_air(int integrator, bool later)
{
    const drape_wind wind = {
        .velocity = {0, 2, 0}, .density = 1.25, .drag = 1.5, .lift = 0.75};
    struct slab d;
    struct arena arena;
    make_small(&d, integrator);
    d.def.dt = 1e-5;
    d.def.gravity[1] = 0;
    d.def.wind = later ? (drape_wind){.velocity = {5, 5, 5},
                                      .density = 1,
                                      .drag = 1,
                                      .lift = 1}
                       : wind;
    d.cloth.u[0] = 0.8;
    d.cloth.u[1] = 0.6;
    struct world *w = slab_inner(&d.def, &arena);
    EXPECT(w);
    if (later)
        EXPECT(control_wind(w, &wind) == DRAPE_OK);
    EXPECT(step_advance(w, NULL) == DRAPE_OK);
    double p[3], size, thrust = 0.5 * 1.25 * 0.0625 * 4 * d.def.dt;
    momentum(w, p, &size);
    EXPECT(fabs(p[1] - 1.5 * 0.8 * thrust) <= 1e-3 * thrust);
    EXPECT(fabs(p[0] + 0.75 * 0.8 * 0.6 * thrust) <= 1e-3 * thrust);
    EXPECT(fabs(p[2]) <= 1e-3 * thrust);
    arena_free(&arena);
    ran(1);
    return NULL;
}

const char *test_world_air(void)
{
    const char *failed = NULL;
    for (int k = 0; k < 2 * METHODS && !failed; k++)
        failed = check_air(methods[k / 2], k % 2);
    return failed;
}

/* kinematics.md §1: a deforming slab moves linearly between its frames and
 * rests after the last; its v is its displacement in a step divided by dt. */
const char *test_world_frames(void)
{
    static double frame[3][8][3], x[2][COUNT + 8][3], v[COUNT + 8][3];
    struct slab d;
    make_small(&d, DRAPE_BW);
    for (int k = 0; k < 24; k++)
        for (int i = 0; i < 3; i++)
            frame[k / 8][k % 8][i] = d.obstacle.x[k % 8][i] +
                                     0.25 * noise_of(3 * (uint64_t)k) * (k > 7);
    d.obstacle.frames = 3;
    d.obstacle.frame_dt = 2.5 * d.def.dt;
    d.obstacle.frame = (const double(*)[3])frame;
    drape_world *world = slab_world(&d);
    EXPECT(world && drape_read(world, x[0], NULL) == DRAPE_OK);
    for (int step = 0; step < 9; step++) {
        drape_step_report r;
        double at = (step + 1) / 2.5;
        int f = at < 1 ? 0 : 1;
        at = at < 2 ? at - f : 1;
        EXPECT(drape_step(world, &r) == DRAPE_OK);
        drape_read(world, x[1], v);
        for (int k = 0; k < 24; k++) {
            double a = frame[f][k / 3][k % 3], b = frame[f + 1][k / 3][k % 3];
            double is = x[1][COUNT + k / 3][k % 3];
            double way = is - x[0][COUNT + k / 3][k % 3];
            EXPECT(fabs(is - (a + at * (b - a))) <= 4 * (double)REAL_UNIT);
            EXPECT(fabs(v[COUNT + k / 3][k % 3] - way / d.def.dt) <= 1e-4);
        }
        memcpy(x[0], x[1], sizeof x[0]);
        ran(1);
    }
    drape_destroy(world);
    return NULL;
}
