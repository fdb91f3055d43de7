/* SPDX-License-Identifier: Apache-2.0 */
/* Cloth between two bodies. spec/validation.md §14 */
#include "validate/pile.h"

#include <math.h>

enum { GAPS = 6 };
static const double gaps[GAPS] = {0.1, 0.3, 0.5, 0.7, 0.9, 0.95};

/* A strip of 50 × 200 mm that hangs, of which jaws hold the upper 50 mm. gap:
 * between them, of two thicknesses; closing: they close on a strip that is
 * pinned and then let go. */
struct jaws {
    double gap, cell, friction, dt, time;
    bool closing;
    const struct scheme *how;
};

/* Hangs it in the plane x = 0, the upper border at this height. */
static void hang(struct pile *p, int m, int n, double h, double top)
{
    int k = pile_sheet(p, m, n, h, (double[3]){0, 0, 0});
    for (int q = 0; q < m * n; q++) {
        double *x = p->place[k][q];
        x[0] = 0;
        x[1] = top - h * (q / m);
        x[2] = h * (q % m) - h * (m - 1) / 2;
    }
}

/* Two boxes on the sides of the plane x = 0, of this half extent along y and z
 * around a height. Returns the first. */
static int pads(struct pile *p, double apart, const double half[2],
                double height, double friction)
{
    int first = p->def.n_obstacles;
    for (int side = 0; side < 2; side++) {
        double in = side ? apart / 2 : -apart / 2, out = side ? 0.1 : -0.1;
        const double lo[3] = {fmin(in, out), height - half[0], -half[1]};
        const double hi[3] = {fmax(in, out), height + half[0], half[1]};
        pile_box(p, lo, hi, friction);
    }
    return first;
}

/* How far the strip falls in the time, m, and its speed then. */
static void jaws_run(const struct validate *v, const struct jaws *t,
                     double out[2])
{
    struct pile p;
    double from[3], to[3], u[3], span = 0.25, begin = 0;
    int m = (int)(0.05 / t->cell + 0.5) + 1;
    int n = (int)(0.2 / t->cell + 0.5) + 1;
    pile_make(v, &p, t->how, t->dt);
    hang(&p, m, n, t->cell, 0.05);
    double open = 2 * pile_thickness(&p, 0);
    double half[2] = {0.05, 0.1};
    pads(&p, open * (t->closing ? 1.1 : t->gap), half, 0.05, t->friction);
    for (int side = 0; t->closing && side < 2; side++) {
        double speed = (side ? -1 : 1) * (1.1 - t->gap) * open / 2 / span;
        p.obstacle[side].motion =
            pile_motion(&p, 0, span, 0, (double[3]){speed, 0, 0});
    }
    for (int i = 0; t->closing && i < m; i++)
        pile_pin(&p, 0, i, 0, -1);
    bool good = pile_start(&p);
    if (good && t->closing) {
        begin = 0.3;
        good = pile_until(&p, begin) &&
               drape_set_pins(p.world, 0, 0, NULL, NULL) == DRAPE_OK;
    }
    if (good)
        pile_mean(&p, 0, p.x, from);
    good = good && pile_until(&p, begin + t->time);
    out[0] = out[1] = NAN;
    if (good) {
        pile_mean(&p, 0, p.x, to);
        pile_mean(&p, 0, p.u, u);
        out[0] = fabs(to[1] - from[1]);
        out[1] = fabs(u[1]);
    }
    pile_free(&p);
}

/* Rows by cells or by steps, of all gaps; one more for the speed. */
static void jaws_rows(struct validate *v, struct jaws t, const double *size,
                      int sizes, bool cells)
{
    char name[160];
    double fastest[SIZES] = {0};
    const char *kind = t.closing ? "jaws that close" : "jaws";
    const char *by = cells ? "by cells" : "by steps";
    for (int q = 0; q < GAPS; q++) {
        t.gap = gaps[q];
        snprintf(name, sizeof name,
                 "%s; %s; %g of two thicknesses apart; %s; way in %g s", kind,
                 by, t.gap, t.how->name, t.time);
        struct property p = pile_row("grip", name, "m", 0, 1e-3);
        p.promised = v->quick;
        for (int k = 0; k < sizes; k++) {
            double got[2];
            *(cells ? &t.cell : &t.dt) = size[k];
            jaws_run(v, &t, got);
            property_add(&p, size[k], got[0]);
            if (!(got[1] <= fastest[k]))
                fastest[k] = got[1];
        }
        property_end(v, &p);
    }
    snprintf(name, sizeof name,
             "%s; %s; %s; largest speed at the end at any distance", kind, by,
             t.how->name);
    struct property p = pile_row("grip", name, "m/s", 0, 1e-3);
    p.promised = v->quick;
    for (int k = 0; k < sizes; k++)
        property_add(&p, size[k], fastest[k]);
    property_end(v, &p);
}

/* A towel of 200 mm that hangs from two small pads. */
static double pinch(const struct validate *v, double dt)
{
    struct pile p;
    double from[3], to[3];
    pile_make(v, &p, schemes, dt);
    hang(&p, 41, 41, 0.005, 0.3);
    pads(&p, 0.002, (double[2]){0.015, 0.04}, 0.28, 1);
    bool good = pile_start(&p);
    if (good)
        pile_mean(&p, 0, p.x, from);
    /* Its free corners sink first. */
    good = good && pile_until(&p, 1);
    if (good)
        pile_mean(&p, 0, p.x, from);
    good = good && pile_until(&p, 2);
    if (good)
        pile_mean(&p, 0, p.x, to);
    pile_free(&p);
    return good ? fabs(to[1] - from[1]) : NAN;
}

/* A strip that is pulled at 20 mm/s from between a floor and a heavy
 * sheet, whose far border is held. out[0]: the force over that of friction on
 * both sides. The force is that of the strain near the drawn end. out[1]: what
 * presses the two sides over twice the sheet's weight, less what its held
 * border bears.
 */
static void plates(const struct validate *v, double friction, double cell,
                   const struct scheme *how, double dt, double out[2])
{
    enum { LAST = 20 };
    struct pile p;
    double pull = 0, press = 0, stiff = 1e4, wide = 0.05;
    int m = (int)(0.2 / cell + 0.5) + 1, n = (int)(wide / cell + 0.5) + 1;
    pile_make(v, &p, how, dt);
    p.material.stretch = stiff;
    p.material.shear = 0.3 * stiff;
    p.material.friction = friction;
    double thick = fmin(p.material.thickness, cell / 2);
    int strip = pile_sheet(&p, m, n, cell, (double[3]){-0.1, thick, -0.025});
    p.material.density = 10;
    p.material.bend = 1e-2;
    int weight = pile_sheet(&p, (m + 1) / 2, n, cell,
                            (double[3]){-0.1037, 2 * thick, -0.0229});
    int ground = 2;
    pile_floor(&p, friction);
    int lead = pile_motion(&p, 0.3, 1.5, 0, (double[3]){0.02, 0, 0});
    for (int j = 0; j < n; j++) {
        pile_pin(&p, strip, m - 1, j, lead);
        pile_pin(&p, weight, 0, j, -1);
    }
    bool good = pile_start(&p) && pile_until(&p, 1);
    int a = (int)(0.15 / cell + 0.5), b = (int)(0.19 / cell + 0.5);
    for (int k = 0; good && k < LAST; k++) {
        good = pile_step(&p) && pile_contacts(&p);
        double strain = 0;
        for (int j = 0; good && j < n; j++)
            strain +=
                ((p.x[b + m * j][0] - p.x[a + m * j][0]) / ((b - a) * cell) -
                 1) /
                n;
        /* Young's modulus along the warp: §4 */
        pull += (1 - 0.09) * stiff * strain * wide / LAST;
        double sum =
            fabs(p.list.impulse[weight][1]) + fabs(p.list.impulse[ground][1]);
        press += good ? sum / p.list.dt / LAST : NAN;
    }
    /* The border bears half of the first column of cells. */
    double due =
        2 * 9.81 * pile_mass(&p, weight) * (1 - 0.5 / (p.cloth[weight].m - 1));
    pile_free(&p);
    out[0] = good ? pull / (friction * press) : NAN;
    out[1] = good ? press / due : NAN;
}

void part_grip(struct validate *v)
{
    static const double cells[] = {0.01, 0.005, 0.002};
    static const double steps[] = {1.0 / 30, 1.0 / 60, 1.0 / 240, 1.0 / 480};
    if (v->quick && v->bits == 32)
        return;
    int some = v->bits == 64 ? SCHEMES : 1;
    for (int closing = 0; closing < 2; closing++) {
        struct jaws t = {.cell = 0.01,
                         .friction = closing ? 0.3 : 1,
                         .dt = 1.0 / 60,
                         .time = v->quick ? 0.2 : 0.5,
                         .closing = closing,
                         .how = schemes};
        jaws_rows(v, t, cells, v->quick ? 1 : v->bits == 64 ? 3 : 2, true);
        for (int s = 0; s < some && !v->quick; s++) {
            t.cell = 0.01;
            t.how = &schemes[s];
            jaws_rows(v, t, steps, s ? 2 : 4, false);
        }
    }
    if (v->quick)
        return;
    struct property p =
        pile_row("grip", "a towel hangs from small pads; way in the second s",
                 "m", 0, 1e-3);
    p.promised = false;
    for (int k = 1; k < 3; k++)
        property_add(&p, steps[k], pinch(v, steps[k]));
    property_end(v, &p);
    static const double mu[] = {0.1, 0.3, 0.6};
    for (int q = 0; q < 3; q++)
        for (int c = 0; c < (q == 1 ? some : 1); c++) {
            char name[2][128];
            snprintf(name[0], sizeof name[0],
                     "pulled from under a weight; friction %g; %s; pull over "
                     "friction of both sides",
                     mu[q], schemes[c].name);
            snprintf(name[1], sizeof name[1],
                     "pulled from under a weight; friction %g; %s; load of "
                     "both sides over the weight's",
                     mu[q], schemes[c].name);
            struct property r[2] = {pile_row("grip", name[0], "1", 1, 0.02),
                                    pile_row("grip", name[1], "1", 1, 0.05)};
            r[0].promised = r[1].promised = false;
            for (int k = 1; k < 3; k++) {
                double got[2];
                plates(v, mu[q], 0.01, &schemes[c], steps[k], got);
                property_add(&r[0], steps[k], got[0]);
                property_add(&r[1], steps[k], got[1]);
            }
            property_end(v, &r[0]);
            property_end(v, &r[1]);
        }
}
