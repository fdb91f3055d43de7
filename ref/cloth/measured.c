/* SPDX-License-Identifier: Apache-2.0 */
/* Finds the laws of springs by which a sheet has the tensions that were
 * measured. spec/cloth/cloth.md §9 */
#include "ref/cloth/measured.h"

#include "ref/cloth/law.h"
#include "ref/cloth/table.h"

enum { SWEEPS = 200, HALVINGS = 60 };
static const double SETTLED = 1e-10;

/* §9.2: f_w, the force of a direction by strain, N/m: linear by k in
 * compression, straight between the knots in tension. */
struct curve {
    double k;
    int knots;
    double strain[DRAPE_POINTS], force[DRAPE_POINTS];
};

static double curve_at(const struct curve *a, double strain)
{
    double e = 0, f = 0;
    int k = 0;
    if (!(strain > 0) || !a->knots)
        return a->k * strain;
    for (; k + 1 < a->knots && strain > a->strain[k]; k++) {
        e = a->strain[k];
        f = a->force[k];
    }
    return f + (a->force[k] - f) / (a->strain[k] - e) * (strain - e);
}

/* §9.1: a test stretches a sheet along one direction and leaves the sides free.
 * `along` and `across` are n_w² and t_w². */
enum { WAYS = 4 };
struct test {
    double along[WAYS], across[WAYS];
    int own; /* the direction whose law is sought */
};

/* The laws that are sought. Both diagonals have that of the bias. */
struct laws {
    struct curve of[DRAPE_TABLES];
};

static const struct curve *curve_of(const struct laws *s, int way)
{
    return &s->of[way < DRAPE_BIAS ? way : DRAPE_BIAS];
}

/* The stretch of a direction in a sheet that is stretched by l and m. */
static double stretch_of(const struct test *t, int way, double l, double m)
{
    return sqrt(t->along[way] * (l * l) + t->across[way] * (m * m));
}

/* §9.1: the force across the test divided by m, which has its sign, N/m. */
static double force_across(const struct laws *s, const struct test *t, double l,
                           double m)
{
    double sum = 0;
    for (int w = 0; w < WAYS; w++) {
        double a = stretch_of(t, w, l, m);
        if (t->across[w] > 0)
            sum += t->across[w] * curve_at(curve_of(s, w), a - 1) / a;
    }
    return sum;
}

/* The stretch across where the sheet is stretched by l along: the force across
 * is 0 there. It grows with m (§9.4). */
static double stretch_across(const struct laws *s, const struct test *t,
                             double l)
{
    double lo = 0, hi = 1;
    for (int k = 0; k < HALVINGS; k++) {
        double m = 0.5 * (lo + hi);
        if (force_across(s, t, l, m) > 0)
            hi = m;
        else
            lo = m;
    }
    return hi;
}

/* The tests in warp, weft and bias. c2, s2: the squares of the cosines of a
 * cell's diagonal with u and with v. */
static void make_tests(const struct cloth *a, struct test test[DRAPE_TABLES])
{
    double hu = (double)a->hu, hv = (double)a->hv;
    double square = hu * hu + hv * hv, c2 = hu * hu / square;
    double s2 = hv * hv / square, cs = hu * hv / square;
    test[DRAPE_WARP] = (struct test){
        .along = {1, 0, c2, c2}, .across = {0, 1, s2, s2}, .own = DRAPE_WARP};
    test[DRAPE_WEFT] = (struct test){
        .along = {0, 1, s2, s2}, .across = {1, 0, c2, c2}, .own = DRAPE_WEFT};
    double with = 0.5 + cs, against = 0.5 * (c2 + s2) - cs;
    against = against > 1e-12 ? against : 0; /* square, up to rounding */
    test[DRAPE_BIAS] = (struct test){.along = {0.5, 0.5, with, against},
                                     .across = {0.5, 0.5, against, with},
                                     .own = DRAPE_BIAS};
}

/* One point of a test. */
struct point {
    double strain; /* of the direction whose law is sought */
    double others; /* N/m, the force along that the other directions bear */
    double factor; /* by which that direction's force counts along */
};

static struct point test_at(const struct laws *s, const struct test *t,
                            double strain)
{
    double l = 1 + strain, m = stretch_across(s, t, l);
    double own = stretch_of(t, t->own, l, m);
    struct point p = {own - 1, 0, t->along[t->own] * l / own};
    for (int w = 0; w < WAYS; w++) {
        double a = stretch_of(t, w, l, m);
        if (w != t->own)
            p.others += t->along[w] * l / a * curve_at(curve_of(s, w), a - 1);
    }
    return p;
}

/* §9.3: sets the law of one table by the others' as they are. Returns whether
 * no knot moved by more than SETTLED of the table's point; one that is NaN
 * did. */
static bool sweep_laws(struct laws *s, const struct test *t,
                       const double table[DRAPE_POINTS][2])
{
    struct curve next = s->of[t->own];
    bool settled = true;
    for (int k = 0; k < next.knots; k++) {
        struct point p = test_at(s, t, table[k][0]);
        double force = (table[k][1] - p.others) / p.factor;
        settled &= fabs(force - next.force[k]) <= SETTLED * table[k][1];
        settled &= fabs(p.strain - next.strain[k]) <= SETTLED * table[k][0];
        next.strain[k] = p.strain;
        next.force[k] = force;
    }
    s->of[t->own] = next;
    return settled;
}

/* §9.3: false if the laws do not settle. */
static bool settle_laws(const drape_material *a, const struct test *test,
                        struct laws *s)
{
    bool settled = false;
    for (int k = 0; k < SWEEPS && !settled; k++) {
        settled = true;
        for (int o = 0; o < DRAPE_TABLES; o++)
            settled &= sweep_laws(s, &test[o], a->table[o]);
    }
    return settled;
}

/* §9.4: the first point of a law at which the tension grows too slowly; -1:
 * none. *least: the force of the law, N/m, that it needs there. */
static int too_soft(const struct curve *a, double *least)
{
    double e = 0, f = 0;
    for (int k = 0; k < a->knots; k++) {
        double step = a->strain[k] - e;
        *least = f + step * (f / (1 + e));
        if (!(step > 0 && a->force[k] >= *least && a->force[k] > 0))
            return k;
        e = a->strain[k];
        f = a->force[k];
    }
    return -1;
}

static void start_laws(const drape_material *a, const struct cloth *c,
                       struct laws *s)
{
    double area = (double)c->hu * (double)c->hv;
    for (int o = 0; o < DRAPE_TABLES; o++) {
        double rest = (double)c->law[o].rest;
        struct curve *f = &s->of[o];
        f->k = (double)c->law[o].k * (rest * rest) / area;
        f->knots = table_points(a->table[o]);
        for (int k = 0; k < f->knots; k++) {
            f->strain[k] = a->table[o][k][0];
            f->force[k] = a->table[o][k][1];
        }
    }
}

/* Writes the pieces of a table, and the law of a direction that has them. */
static void write_law(const struct curve *a, double area, struct law *law,
                      struct piece *piece)
{
    double rest = (double)law->rest, per_length = area / rest;
    double e = 0, f = 0, work = 0, stiff = (double)law->k;
    for (int k = 0; k < a->knots; k++) {
        double step = (a->strain[k] - e) * rest;
        double rise = (a->force[k] - f) * per_length;
        piece[k] = (struct piece){.from = (real)(rest * (1 + e)),
                                  .slope = (real)(rise / step),
                                  .pull = (real)(f * per_length),
                                  .work = (real)work};
        work += step * (f * per_length + 0.5 * rise);
        stiff = rise / step > stiff ? rise / step : stiff;
        e = a->strain[k];
        f = a->force[k];
    }
    law->pieces = (int32_t)a->knots;
    law->from = law->rest;
    law->stiff = real_max(
        law->stiff, (real)(stiff + 2 * (double)law->gain * (double)law->over));
}

/* §9.4: whether all laws grow fast enough; else *misfit names the first point
 * that does not. */
static bool all_fit(const drape_material *a, const struct laws *s,
                    const struct test *test, struct misfit *misfit)
{
    for (int o = 0; o < DRAPE_TABLES; o++) {
        double least;
        int point = too_soft(&s->of[o], &least);
        if (point < 0)
            continue;
        struct point p = test_at(s, &test[o], a->table[o][point][0]);
        *misfit = (struct misfit){MISFIT_SOFT, (enum drape_table)o, point,
                                  p.others + p.factor * least};
        return false;
    }
    return true;
}

/* The first table that is given; DRAPE_TABLES: none is. */
static enum drape_table first_table(const drape_material *a)
{
    int o = 0;
    while (o < DRAPE_TABLES && !table_points(a->table[o]))
        o++;
    return (enum drape_table)o;
}

int measured_laws(const drape_material *a, struct cloth *c)
{
    struct test test[DRAPE_TABLES];
    struct laws s;
    double area = (double)c->hu * (double)c->hv;
    enum drape_table first = first_table(a);
    c->misfit = (struct misfit){.kind = MISFIT_NONE};
    c->pieces = 0;
    memset(c->piece, 0, sizeof c->piece);
    if (first == DRAPE_TABLES)
        return DRAPE_OK;
    c->misfit = (struct misfit){.kind = MISFIT_BENDING, .table = first};
    if (!c->triples)
        return DRAPE_EARG;
    make_tests(c, test);
    start_laws(a, c, &s);
    c->misfit = (struct misfit){.kind = MISFIT_UNSETTLED};
    if (!settle_laws(a, test, &s) || !all_fit(a, &s, test, &c->misfit))
        return DRAPE_EARG;
    c->misfit = (struct misfit){.kind = MISFIT_NONE};
    c->pieces = PIECES;
    for (int o = 0; o < SPRINGS_SINGLE; o++) {
        struct law *law = &c->law[o];
        int table = o < DRAPE_BIAS ? o : DRAPE_BIAS;
        law->first = DRAPE_POINTS * table;
        if (s.of[table].knots)
            write_law(&s.of[table], area, law, c->piece + law->first);
    }
    return DRAPE_OK;
}
