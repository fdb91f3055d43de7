/* SPDX-License-Identifier: Apache-2.0 */
/* A belt on a drum: the capstan's law. spec/validation.md §15 */
#include "validate/pile.h"

#include <math.h>
#include <stdlib.h>

static const double radius = 0.1, span = 0.1; /* m, of drum and free parts */
static const double strain = 0.0036;          /* at the start */

/* A belt over half of a drum, both ends straight down, without gravity. */
struct belt {
    double friction, cell, dt;
    int wide, facets; /* cells across */
    const struct scheme *how;
    /* How the ends move: `pull` m/s at one end, `give` at the other. */
    double pull, give, begin, end, time;
};

/* What is seen of it: the logarithm of the two tensions' quotient over that of
 * the law, in the mean of the last third; the speed across the belt over that
 * along it; the quotient at which the far end's tension has grown by a tenth,
 * and its change after the ends have stopped. */
struct drawn {
    double quotient, aside, onset, keeps;
};

/* A belt in a world. */
struct wound {
    struct pile p;
    int m, n;
    double rest; /* m, of a cell */
};

static void wind_up(const struct validate *v, struct wound *w,
                    const struct belt *t)
{
    struct pile *p = &w->p;
    double pi = acos(-1);
    pile_make(v, p, t->how, t->dt);
    p->def.gravity[1] = 0;
    p->material.friction = t->friction;
    double out = radius + fmin(p->material.thickness, t->cell / 2);
    double arc = pi * out, all = arc + 2 * span;
    w->m = (int)(all / t->cell + 0.5) + 1;
    w->n = t->wide + 1;
    w->rest = all / (1 + strain) / (w->m - 1);
    int q = pile_sheet(p, w->m, w->n, w->rest, (double[3]){0, 0, 0});
    for (int k = 0; k < w->m * w->n; k++) {
        double s = all * (k % w->m) / (w->m - 1), *x = p->place[q][k];
        double a = pi - (s - span) / out;
        bool on = s > span && s < span + arc;
        x[0] = on ? out * cos(a) : s < span + arc / 2 ? -out : out;
        x[1] = on ? out * sin(a) : s <= span ? s - span : span + arc - s;
        /* Narrower by Poisson's ratio */
        x[2] = w->rest * (k / w->m - 0.5 * t->wide) * (1 - 0.3 * strain);
    }
    pile_drum(p, radius, w->rest * t->wide + 0.05, t->facets, t->friction);
    int lead[2];
    lead[0] = pile_motion(p, t->begin, t->end, 0.1, (double[3]){0, t->give, 0});
    lead[1] =
        pile_motion(p, t->begin, t->end, 0.1, (double[3]){0, -t->pull, 0});
    for (int j = 0; j < w->n; j++) {
        pile_pin(p, q, 0, j, lead[0]);
        pile_pin(p, q, w->m - 1, j, lead[1]);
    }
}

/* The mean strain along the belt between two columns. */
static double strain_of(const struct wound *w, int a, int b)
{
    double sum = 0;
    for (int j = 0; j < w->n; j++) {
        const double *x = w->p.x[a + w->m * j], *y = w->p.x[b + w->m * j];
        double d = hypot(hypot(x[0] - y[0], x[1] - y[1]), x[2] - y[2]);
        sum += d / ((b - a) * w->rest) - 1;
    }
    return sum / w->n;
}

/* Tensions of both free parts, in their middles, as strains. */
static void tensions(const struct wound *w, double out[2])
{
    int a = (int)(0.25 * span / w->rest + 0.5);
    int b = (int)(0.75 * span / w->rest + 0.5);
    out[0] = strain_of(w, a, b);
    out[1] = strain_of(w, w->m - 1 - b, w->m - 1 - a);
}

static double aside(const struct wound *w)
{
    double sum = 0;
    int64_t n = 0;
    for (int k = 0; k < w->m * w->n; k++)
        if (w->p.x[k][1] > 0.02) {
            sum += w->p.u[k][2] * w->p.u[k][2];
            n++;
        }
    return sqrt(sum / (double)n);
}

static struct drawn draw(const struct validate *v, const struct belt *t)
{
    struct wound w;
    struct drawn out = {NAN, NAN, NAN, NAN};
    double now[2], first = 0, mean = 0, across = 0, at_end = 0, law, quotient;
    wind_up(v, &w, t);
    law = t->friction * acos(-1);
    bool good = pile_start(&w.p) && pile_until(&w.p, t->begin);
    if (good) {
        tensions(&w, now);
        first = now[0];
    }
    int steps = (int)((t->time - t->begin) / t->dt + 0.5);
    int last = 0;
    for (int k = 0; good && k < steps; k++) {
        good = pile_step(&w.p);
        if (!good)
            break;
        tensions(&w, now);
        quotient = log(now[1] / now[0]) / law;
        if (isnan(out.onset) && now[0] / first > 1.1)
            out.onset = quotient;
        if (at_end == 0 && (double)w.p.steps * t->dt > t->end)
            at_end = quotient;
        if (3 * k > 2 * steps) {
            mean += quotient;
            across += aside(&w);
            last++;
        }
    }
    if (good) {
        out.quotient = mean / last;
        out.aside = across / last / fmax(fabs(t->pull), 1e-3);
        out.keeps = mean / last / at_end;
    }
    pile_free(&w.p);
    return out;
}

static const struct belt plain = {.friction = 0.3,
                                  .cell = 0.008,
                                  .dt = 1.0 / 60,
                                  .wide = 4,
                                  .facets = 128,
                                  .how = schemes,
                                  .pull = 0.01,
                                  .give = 0.01,
                                  .begin = 0.1,
                                  .end = 9,
                                  .time = 1.1};

/* Rows of sliding belts by cells or steps. */
static void slides(struct validate *v, const char *name, struct belt t,
                   const double *size, int sizes, bool cells)
{
    char names[2][160];
    snprintf(names[0], sizeof names[0],
             "slides; %s; logarithm of tensions' quotient over the law's",
             name);
    snprintf(names[1], sizeof names[1],
             "slides; %s; speed across the belt over that along it", name);
    struct property p = pile_row("belt", names[0], "1", 1, 0.05);
    struct property q = pile_row("belt", names[1], "1", 0, 0.05);
    p.promised = t.friction > 0.1;
    double width = t.wide * t.cell;
    for (int k = 0; k < sizes; k++) {
        if (cells) {
            t.cell = size[k];
            t.wide = (int)(width / t.cell + 0.5);
        } else
            t.dt = size[k];
        struct drawn got = draw(v, &t);
        property_add(&p, size[k], got.quotient);
        property_add(&q, size[k], got.aside);
    }
    property_end(v, &p);
    property_end(v, &q);
}

/* One end is drawn, the other held: it feels nothing until the quotient is the
 * law's. Drawn by less, the belt keeps its tensions. */
static void sticks(struct validate *v, const struct scheme *how,
                   const double *steps, int sizes)
{
    char name[2][160];
    snprintf(name[0], sizeof name[0],
             "sticks; %s; onset; logarithm of tensions' quotient over the "
             "law's",
             how->name);
    snprintf(name[1], sizeof name[1],
             "sticks; %s; the same after 1 s over that before", how->name);
    struct property p = pile_row("belt", name[0], "1", 1, 0.05);
    struct property q = pile_row("belt", name[1], "1", 1, 0.05);
    for (int k = 0; k < sizes; k++) {
        struct belt t = plain;
        t.dt = steps[k];
        t.how = how;
        t.give = 0;
        t.pull = 2e-3;
        t.begin = 0.5; /* by then it lies still on its facets */
        t.time = 2;
        property_add(&p, t.dt, draw(v, &t).onset);
        t.end = 0.7;
        property_add(&q, t.dt, draw(v, &t).keeps);
    }
    property_end(v, &p);
    property_end(v, &q);
}

void part_belt(struct validate *v)
{
    static const double steps[] = {1.0 / 60, 1.0 / 240};
    static const double cells[] = {0.012, 0.008, 0.004};
    static const double mu[] = {0.1, 0.3, 0.6};
    if (v->quick && v->bits == 32)
        return;
    char name[96];
    int some = v->bits == 64 ? SCHEMES : 1;
    struct belt t = plain;
    if (v->quick) {
        t.cell = 0.012;
        t.wide = 2;
        t.time = 0.7;
        slides(v, "friction 0.3", t, steps, 1, false);
        return;
    }
    for (int k = 0; k < 3; k++) {
        t = plain;
        t.friction = mu[k];
        snprintf(name, sizeof name, "friction %g", mu[k]);
        slides(v, name, t, steps, 2, false);
    }
    for (int s = 1; s < some; s++) {
        t = plain;
        t.how = &schemes[s];
        slides(v, schemes[s].name, t, steps, 2, false);
    }
    t = plain;
    t.cell = 0.012;
    t.wide = 4;
    slides(v, "friction 0.3; by cells; 48 mm wide", t, cells,
           v->bits == 64 ? 3 : 2, true);
    t.wide = 2;
    slides(v, "friction 0.3; by cells; 24 mm wide", t, cells,
           v->bits == 64 ? 3 : 2, true);
    t = plain;
    t.facets = 16;
    slides(v, "friction 0.3; 16 facets", t, steps, 2, false);
    t.facets = 40;
    slides(v, "friction 0.3; 40 facets", t, steps, 2, false);
    for (int s = 0; s < some; s++)
        sticks(v, &schemes[s], steps, 2);
}
