/* SPDX-License-Identifier: Apache-2.0 */
/* Sheets on sheets. spec/validation.md §13 */
#include "validate/pile.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double g = 9.81;

static void tilt(struct pile *p, double degrees)
{
    double a = degrees * acos(-1) / 180;
    p->def.gravity[0] = g * sin(a);
    p->def.gravity[1] = -g * cos(a);
}

/* What pulls a block down the slope, m/s². */
static double pull(double degrees, double friction)
{
    double a = degrees * acos(-1) / 180;
    return g * (sin(a) - friction * cos(a));
}

/* The way in a time from this speed on, by steps of the scheme: backward
 * Euler's sum of speeds, or that of second order. */
static double way_of(const struct scheme *how, double speed, double a,
                     double span, double dt)
{
    bool first = how->integrator == DRAPE_BW;
    return speed * span + a * span * (span + (first ? dt : 0)) / 2;
}

/* A stack: what is measured of it. */
struct stack {
    int sheets, side;                      /* particles a side */
    double cell, degrees, friction, apart; /* apart: m, a sheet to the next */
    double heavy; /* of the uppermost, times the others' density */
    const struct scheme *how;
    double dt, time;
};

/* way: the farthest mean way of a sheet, m; speed: the largest at the end, m/s;
 * law: over Coulomb's way of a block, the value that is farthest from 1; load:
 * the floor's share of all weights; least: the worst share of a layer in what
 * lies on it; height: the least distance of two means, of the thickness;
 * iterations: a step. */
struct stacked {
    double way, speed, law, load, least, height, iterations;
};

/* Sheets one above the other, a thickness apart, moved by `apart` in turn. */
static void stack_make(const struct validate *v, struct pile *p,
                       const struct stack *t)
{
    pile_make(v, p, t->how, t->dt);
    tilt(p, t->degrees);
    p->material.friction = t->friction;
    double thick = fmin(p->material.thickness, t->cell / 2);
    for (int k = 0; k < t->sheets; k++) {
        const double at[3] = {t->apart * (k % 3), thick * (k + 1),
                              t->apart / 2 * (k % 2)};
        if (k == t->sheets - 1)
            p->material.density *= t->heavy;
        pile_sheet(p, t->side, t->side, t->cell, at);
    }
    pile_floor(p, t->friction);
}

/* Adds what presses from the layer below on each body: [k] is what sheet k gets
 * from below, upward. */
static void loads(struct pile *p, double *load)
{
    for (int64_t k = 0; k < p->list.n; k++) {
        const drape_contact *t = &p->list.contact[k];
        int upper = t->body[0], lower = t->body[1], n = p->def.n_cloths;
        double sign = 1;
        if (lower < n && (upper >= n || lower > upper)) {
            int swap = upper;
            upper = lower;
            lower = swap;
            sign = -1;
        }
        if (upper < n && upper != lower)
            load[upper] += sign * t->impulse[1] / p->list.dt;
    }
}

static struct stacked stack_run(const struct validate *v, const struct stack *t)
{
    enum { LAST = 10 };
    struct stacked out = {NAN, NAN, NAN, NAN, NAN, NAN, NAN};
    struct pile p;
    double from[PILE_CLOTHS][3], to[3], u[3], early[PILE_CLOTHS][2];
    double load[PILE_CLOTHS] = {0};
    int steps = (int)(t->time / t->dt + 0.5), first = (int)(0.1 / t->dt + 0.5);
    stack_make(v, &p, t);
    bool good = pile_start(&p);
    for (int k = 0; good && k < t->sheets; k++)
        pile_mean(&p, k, p.x, from[k]);
    for (int s = 1; good && s <= steps; s++) {
        good = pile_step(&p);
        if (good && s > steps - LAST) {
            good = pile_contacts(&p);
            loads(&p, load);
        }
        for (int k = 0; good && s == first && k < t->sheets; k++) {
            pile_mean(&p, k, p.x, to);
            pile_mean(&p, k, p.u, u);
            early[k][0] = to[0];
            early[k][1] = u[0];
        }
    }
    double above = 0, below = 0, due = g * cos(t->degrees * acos(-1) / 180);
    if (good) {
        out = (struct stacked){0, 0, 1, 0, 1, INFINITY, 0};
        out.iterations = (double)p.iterations / steps;
    }
    for (int k = t->sheets - 1; good && k >= 0; k--) {
        above += due * pile_mass(&p, k);
        double share = load[k] / LAST / above;
        if (fabs(share - 1) > fabs(out.least - 1))
            out.least = share;
        out.load = share; /* at last the floor's */
    }
    for (int k = 0; good && k < t->sheets; k++) {
        double span = (steps - first) * t->dt;
        double a = pull(t->degrees, t->friction);
        pile_mean(&p, k, p.x, to);
        pile_mean(&p, k, p.u, u);
        out.way = fmax(out.way, hypot(to[0] - from[k][0], to[2] - from[k][2]));
        out.speed = fmax(out.speed, hypot(u[0], u[2]));
        double law =
            (to[0] - early[k][0]) / way_of(t->how, early[k][1], a, span, t->dt);
        if (!(fabs(law - 1) < fabs(out.law - 1)))
            out.law = law;
        out.height = fmin(out.height, (to[1] - below) / pile_thickness(&p, k));
        below = to[1];
    }
    pile_free(&p);
    return out;
}

static const struct stack plain = {.sheets = 2,
                                   .side = 11,
                                   .cell = 0.02,
                                   .friction = 0.3,
                                   .apart = 0.0037,
                                   .heavy = 1,
                                   .how = schemes,
                                   .dt = 1.0 / 60,
                                   .time = 1};

enum what { WAY, SPEED, LAW, LOAD, LEAST, HEIGHT };
struct asked {
    const char *name, *unit;
    double theory, bar;
};
static const struct asked rows[] = {
    [WAY] = {"farthest way", "m", 0, 1e-3},
    [SPEED] = {"largest speed at the end", "m/s", 0, 1e-3},
    [LAW] = {"way over Coulomb's", "1", 1, 0.02},
    [LOAD] = {"floor's share of all weights", "1", 1, 0.01},
    [LEAST] = {"share of a sheet in what lies on it", "1", 1, 0.01},
    [HEIGHT] = {"least distance of two sheets; of the thickness", "1", 1, 0.1}};

static double asked_of(const struct stacked *s, enum what q)
{
    const double value[] = {s->way,  s->speed, s->law,
                            s->load, s->least, s->height};
    return value[q];
}

/* Rows of a stack at several sizes: of steps, or of cells. */
static void stack_rows(struct validate *v, const char *name, struct stack t,
                       const enum what *what, int kinds, const double *size,
                       int sizes, bool cells)
{
    struct property p[4];
    char names[4][160];
    for (int q = 0; q < kinds; q++) {
        const struct asked *a = &rows[what[q]];
        snprintf(names[q], sizeof names[q], "%s; %s", name, a->name);
        p[q] = pile_row("layers", names[q], a->unit, a->theory, a->bar);
    }
    double side = t.cell * (t.side - 1);
    for (int k = 0; k < sizes; k++) {
        if (cells) {
            t.cell = size[k];
            t.side = (int)(side / t.cell + 0.5) + 1;
        } else
            t.dt = size[k];
        struct stacked got = stack_run(v, &t);
        for (int q = 0; q < kinds; q++)
            property_add(&p[q], size[k], asked_of(&got, what[q]));
    }
    for (int q = 0; q < kinds; q++)
        property_end(v, &p[q]);
}

static const double step[] = {1.0 / 60, 1.0 / 240};
static const double cells[] = {0.02, 0.01, 0.005};

/* Stacks on slopes: they rest, or slide as a block. */
static void slopes(struct validate *v)
{
    static const enum what rest[] = {WAY, SPEED}, slide[] = {LAW};
    char name[96];
    int some = v->bits == 64 ? SCHEMES : 1;
    for (int n = v->quick ? 2 : 1; n <= 8; n *= v->quick ? 4 : 2)
        for (int down = 0; down < 2; down++) {
            struct stack t = plain;
            t.sheets = n;
            t.degrees = down ? 25 : 12;
            t.time = down || v->quick ? 0.6 : 1;
            snprintf(name, sizeof name, "%d sheets at %g degrees", n,
                     t.degrees);
            stack_rows(v, name, t, down ? slide : rest, down ? 1 : 2, step,
                       v->quick ? 1 : 2, false);
        }
    for (int down = 0; down < 2 && !v->quick; down++) {
        struct stack t = plain;
        t.degrees = down ? 25 : 12;
        t.time = down ? 0.6 : 1;
        for (int s = 1; s < some; s++) {
            t.how = &schemes[s];
            snprintf(name, sizeof name, "2 sheets at %g degrees; %s", t.degrees,
                     schemes[s].name);
            stack_rows(v, name, t, down ? slide : rest, down ? 1 : 2, step, 2,
                       false);
        }
        t.how = schemes;
        snprintf(name, sizeof name, "2 sheets at %g degrees; by cells",
                 t.degrees);
        stack_rows(v, name, t, down ? slide : rest, down ? 1 : 2, cells, 3,
                   true);
        t.apart = 0;
        snprintf(name, sizeof name,
                 "2 sheets at %g degrees; particle on particle", t.degrees);
        stack_rows(v, name, t, down ? slide : rest, down ? 1 : 2, step, 2,
                   false);
    }
}

/* The exponent of y over x by least squares on logarithmic scales. */
static double exponent(int n, const double *x, const double *y)
{
    double sx = 0, sy = 0, xx = 0, xy = 0;
    for (int k = 0; k < n; k++) {
        double a = log(x[k]), b = log(y[k]);
        sx += a;
        sy += b;
        xx += a * a;
        xy += a * b;
    }
    return (n * xy - sx * sy) / (n * xx - sx * sx);
}

/* Weights and heights of stacks on a level floor, and work over the number of
 * sheets. */
static void weights(struct validate *v)
{
    static const enum what all[] = {LOAD, LEAST, HEIGHT};
    double sheets[8], work[8];
    int count = 0;
    char name[96];
    for (int n = v->quick ? 4 : 1; n <= (v->quick ? 16 : 32);
         n *= v->quick ? 4 : 2) {
        struct stack t = plain;
        t.sheets = n;
        t.side = 7;
        struct property p[3];
        char names[3][128];
        struct stacked got = stack_run(v, &t);
        for (int q = 0; q < 3; q++) {
            const struct asked *a = &rows[all[q]];
            snprintf(names[q], sizeof names[q], "%d sheets; %s", n, a->name);
            p[q] = pile_row("layers", names[q], a->unit, a->theory, a->bar);
            property_add(&p[q], t.cell, asked_of(&got, all[q]));
            property_end(v, &p[q]);
        }
        snprintf(name, sizeof name, "%d sheets; iterations a step", n);
        struct property w = pile_row("layers", name, "1", 0, NAN);
        property_add(&w, t.cell, got.iterations);
        property_end(v, &w);
        sheets[count] = n;
        work[count++] = fmax(1, got.iterations);
    }
    if (v->quick)
        return;
    struct property p = pile_row(
        "layers", "iterations a step from 2 to 32 sheets; exponent; from 1 on",
        "1", 1, 0.05);
    property_add(&p, plain.cell,
                 fmax(1, exponent(count - 1, sheets + 1, work + 1)));
    property_end(v, &p);
    for (int heavy = 10; heavy <= 100; heavy *= 10) {
        struct stack t = plain;
        t.sheets = 3;
        t.heavy = heavy;
        snprintf(name, sizeof name, "3 sheets; the uppermost %d times as heavy",
                 heavy);
        stack_rows(v, name, t, all, 3, step, 2, false);
    }
    struct stack t = plain;
    t.sheets = 5;
    t.apart = 0;
    t.time = 2;
    stack_rows(v, "5 sheets; particle on particle", t, all + 2, 1, step, 2,
               false);
}

/* Three sheets without friction, moved by 1 mm each. */
static void slippery(struct validate *v)
{
    static const enum what way[] = {WAY};
    struct stack t = {.sheets = 3,
                      .side = 21,
                      .cell = 0.02,
                      .apart = 1e-3,
                      .heavy = 1,
                      .how = schemes,
                      .time = 3};
    stack_rows(v, "3 sheets without friction", t, way, 1, step, 2, false);
}

/* A sheet on a sheet that lies on the floor and is held at its upper border. */
static double held(const struct validate *v, double degrees,
                   const struct scheme *how, double dt)
{
    struct pile p;
    double from[2][3], to[3], u[3];
    pile_make(v, &p, how, dt);
    tilt(&p, degrees);
    const double low[3] = {-0.05, 0.002, -0.05},
                 up[3] = {0.0037, 0.004, 0.0021};
    pile_sheet(&p, 31, 21, 0.02, low);
    pile_sheet(&p, 11, 11, 0.02, up);
    for (int k = 0; k < 21; k++)
        pile_pin(&p, 0, 0, k, -1);
    pile_floor(&p, 0.3);
    bool good = pile_start(&p) && pile_until(&p, 0.1);
    double a = pull(degrees, 0.3), span = 0.4, way = NAN;
    if (good) {
        pile_mean(&p, 1, p.x, from[0]);
        pile_mean(&p, 1, p.u, u);
        good = pile_until(&p, 0.5);
    }
    if (good) {
        pile_mean(&p, 1, p.x, to);
        way = to[0] - from[0][0];
        if (a > 0)
            way /= way_of(how, u[0], a, span, dt);
    }
    pile_free(&p);
    return way;
}

static void upper(struct validate *v)
{
    int some = v->bits == 64 ? SCHEMES : 1;
    for (int s = 0; s < some; s++)
        for (int down = 0; down < 2; down++) {
            char name[128];
            double degrees = down ? 25 : 15;
            snprintf(name, sizeof name,
                     "a sheet on a held one at %g degrees; %s; %s", degrees,
                     schemes[s].name, rows[down ? LAW : WAY].name);
            struct property p = pile_row("layers", name, down ? "1" : "m", down,
                                         down ? 0.02 : 1e-3);
            p.promised = !down;
            for (int k = 0; k < 2; k++)
                property_add(&p, step[k],
                             held(v, degrees, &schemes[s], step[k]));
            property_end(v, &p);
        }
}

/* A sheet that is folded once on itself, with a bend of 10 mm across: along is
 * the way of its length, down the slope or across it. Way after a second in
 * which it settles. */
static void folded(const struct validate *v, bool aside, double cell,
                   const struct scheme *how, double dt, double out[2])
{
    struct pile p;
    double radius = 0.005, pi = acos(-1), half = 0.1, from[3], to[3], u[3];
    pile_make(v, &p, how, dt);
    tilt(&p, 6);
    p.material.thickness = 0.001;
    double length = 2 * half + pi * radius;
    int m = (int)(length / cell + 0.5) + 1, n = (int)(0.1 / cell + 0.5) + 1;
    pile_sheet(&p, m, n, cell, (double[3]){0, 0.001, 0});
    double(*x)[3] = p.place[0];
    for (int k = 0; k < m * n; k++) {
        double s = cell * (k % m), z = cell * (k / m), at, up;
        double turn = (s - half) / radius, back = s - half - pi * radius;
        at = s < half ? s : back > 0 ? half - back : half + radius * sin(turn);
        up = s < half ? 0 : back > 0 ? 2 * radius : radius * (1 - cos(turn));
        x[k][0] = aside ? z : at;
        x[k][1] = 0.001 + up;
        x[k][2] = aside ? at : z;
    }
    pile_floor(&p, 0.3);
    bool good = pile_start(&p) && pile_until(&p, 1);
    if (good) {
        pile_mean(&p, 0, p.x, from);
        good = pile_until(&p, 2);
    }
    out[0] = out[1] = NAN;
    if (good) {
        pile_mean(&p, 0, p.x, to);
        pile_mean(&p, 0, p.u, u);
        out[0] = hypot(to[0] - from[0], to[2] - from[2]);
        out[1] = hypot(u[0], u[2]);
    }
    pile_free(&p);
}

static void folds(struct validate *v)
{
    for (int aside = 0; aside < 2; aside++) {
        struct property p[2];
        char name[2][128];
        for (int q = 0; q < 2; q++) {
            snprintf(name[q], sizeof name[q],
                     "a fold at 6 degrees; its line %s; %s",
                     aside ? "along the slope" : "across the slope",
                     q ? rows[SPEED].name : "way in 1 s");
            p[q] = pile_row("layers", name[q], q ? "m/s" : "m", 0, 1e-3);
        }
        for (int k = 0; k < (v->quick ? 1 : 2); k++) {
            double got[2];
            folded(v, aside, 0.005, schemes, step[k], got);
            for (int q = 0; q < 2; q++)
                property_add(&p[q], step[k], got[q]);
        }
        for (int q = 0; q < 2; q++)
            property_end(v, &p[q]);
    }
}

/* A cloth is pulled at 1 m/s from under a stiff napkin. out: how far the
 * napkin went, m; its largest speed, over what friction allows since the start.
 */
static void pulled(const struct validate *v, double friction, double dt,
                   double out[2])
{
    struct pile p;
    double at[3], from[3], u[3], most = 0;
    pile_make(v, &p, schemes, dt);
    p.material.friction = friction;
    int cloth = pile_sheet(&p, 41, 11, 0.02, (double[3]){-0.4, 0.002, -0.1});
    p.material.bend = 1e-2;
    int napkin =
        pile_sheet(&p, 9, 9, 0.01, (double[3]){-0.1631, 0.004, -0.037});
    pile_floor(&p, friction);
    int lead = pile_motion(&p, 0.2, 0.6, 0.05, (double[3]){1, 0, 0});
    for (int j = 0; j < 11; j++)
        pile_pin(&p, cloth, 40, j, lead);
    bool good = pile_start(&p) && pile_until(&p, 0.2);
    if (good)
        pile_mean(&p, napkin, p.x, from);
    while (good && (double)p.steps * dt < 0.3) {
        good = pile_step(&p);
        if (!good)
            break;
        pile_mean(&p, napkin, p.u, u);
        double time = (double)p.steps * dt - 0.2;
        if (time > 0.05)
            most = fmax(most, hypot(u[0], u[2]) / (friction * g * time));
    }
    if (good)
        pile_mean(&p, napkin, p.x, at);
    out[0] = good ? hypot(at[0] - from[0], at[2] - from[2]) : NAN;
    out[1] = good ? most : NAN;
    pile_free(&p);
}

static void tablecloth(struct validate *v)
{
    double got[2];
    struct property stays = pile_row(
        "layers", "a cloth pulled from under a napkin; no friction; way", "m",
        0, 1e-3);
    struct property goes = pile_row(
        "layers",
        "a cloth pulled from under a napkin; friction 0.2; speed over mu g t",
        "1", 1, 0.05);
    stays.promised = goes.promised = false;
    for (int k = 0; k < 2; k++) {
        pulled(v, 0, step[k], got);
        property_add(&stays, step[k], got[0]);
        pulled(v, 0.2, step[k], got);
        property_add(&goes, step[k], got[1]);
    }
    property_end(v, &stays);
    property_end(v, &goes);
}

void part_layers(struct validate *v)
{
    if (v->quick && v->bits == 32)
        return;
    slopes(v);
    weights(v);
    folds(v);
    if (v->quick)
        return;
    upper(v);
    slippery(v);
    tablecloth(v);
}
