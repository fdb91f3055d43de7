/* SPDX-License-Identifier: Apache-2.0 */
/* A sheet that falls flat. spec/validation.md §16 */
#include "validate/pile.h"

#include <math.h>

/* Sheets one above the other that come at 1 m/s, and at `aside` along the
 * floor, without gravity. high: where the lowest starts, m. */
struct fall {
    int sheets;
    double cell, aside, friction, high, dt, gravity;
    const struct scheme *how;
};

/* out[0]: the largest mean speed upward of a sheet after the impact, over that
 * before; out[1]: the speed along the floor that was lost. */
static void fall(const struct validate *v, const struct fall *t, double out[2])
{
    struct pile p;
    double u[3], most = 0, lost = 0;
    pile_make(v, &p, t->how, t->dt);
    p.def.gravity[1] = -t->gravity;
    p.material.friction = t->friction;
    int m = (int)(0.1 / t->cell + 0.5) + 1;
    for (int k = 0; k < t->sheets; k++) {
        const double at[3] = {0.0037 * (k % 3), t->high + 0.002 * k,
                              0.0021 * (k % 2)};
        int q = pile_sheet(&p, m, m, t->cell, at);
        for (int i = 0; i < m * m; i++) {
            p.speed[q][i][0] = t->aside;
            p.speed[q][i][1] = -1;
        }
    }
    pile_floor(&p, t->friction);
    bool good = pile_start(&p);
    while (good && (double)p.steps * t->dt < 0.06) {
        good = pile_step(&p);
        for (int k = 0; good && k < t->sheets; k++) {
            pile_mean(&p, k, p.u, u);
            most = fmax(most, u[1]);
        }
    }
    for (int k = 0; good && k < t->sheets; k++) {
        pile_mean(&p, k, p.u, u);
        lost += (t->aside - u[0]) / t->sheets;
    }
    pile_free(&p);
    out[0] = good ? most : NAN;
    out[1] = good ? lost : NAN;
}

/* The worst of three heights, so that the impact is at other times of its step.
 */
static void falls(const struct validate *v, struct fall t, double due,
                  double out[2])
{
    static const double high[] = {0.008, 0.011, 0.019};
    out[0] = 0;
    out[1] = due;
    for (int k = 0; k < 3; k++) {
        double got[2];
        t.high = high[k];
        fall(v, &t, got);
        if (!(got[0] <= out[0]))
            out[0] = got[0];
        if (!(fabs(got[1] - due) <= fabs(out[1] - due)))
            out[1] = got[1];
    }
}

static const double steps[] = {1.0 / 60, 1.0 / 240, 1.0 / 960, 1.0 / 1920};

static void restitution(struct validate *v, struct fall t, const char *what)
{
    char name[128];
    snprintf(name, sizeof name, "%s; %s; restitution", what, t.how->name);
    struct property p = pile_row("impact", name, "1", 0, 0.05);
    p.promised = t.sheets == 1 || t.how == schemes;
    for (int k = 0; k < (v->quick ? 1 : t.sheets > 1 ? 3 : 4); k++) {
        double got[2];
        t.dt = steps[k];
        falls(v, t, 0, got);
        property_add(&p, steps[k], got[0]);
    }
    property_end(v, &p);
}

static void oblique(struct validate *v, struct fall t)
{
    char name[160];
    double due = fmin(t.friction, t.aside);
    snprintf(name, sizeof name,
             "%d sheet%s at %g m/s along the floor; friction %g; %s; speed "
             "lost over the law's",
             t.sheets, t.sheets > 1 ? "s" : "", t.aside, t.friction,
             t.how->name);
    struct property p = pile_row("impact", name, "1", 1, 0.02);
    p.promised = t.sheets == 1 && t.how->integrator == DRAPE_BW;
    /* The small form has the step by which a sheet may come within its
     * thickness without touching. */
    for (int k = v->quick ? 2 : 0; k < 3; k++) {
        double got[2];
        t.dt = steps[k];
        falls(v, t, due, got);
        property_add(&p, steps[k], got[1] / due);
    }
    property_end(v, &p);
}

void part_impact(struct validate *v)
{
    if (v->quick && v->bits == 32)
        return;
    int some = v->bits == 64 ? SCHEMES : 1;
    for (int s = 0; s < some; s++) {
        struct fall t = {
            .sheets = 1, .cell = 0.01, .friction = 0.3, .how = &schemes[s]};
        restitution(v, t, "a sheet falls flat");
        t.gravity = 9.81;
        if (!v->quick)
            restitution(v, t, "a sheet falls flat by gravity");
        t.gravity = 0;
        t.sheets = 4;
        restitution(v, t, "four sheets fall flat");
        t.sheets = 1;
        t.aside = 0.5;
        oblique(v, t);
        if (v->quick)
            continue;
        t.friction = 0.1;
        oblique(v, t);
        t.friction = 0.3;
        t.aside = 0.2;
        oblique(v, t);
        t.aside = 0.5;
        t.sheets = 4;
        oblique(v, t);
    }
}
