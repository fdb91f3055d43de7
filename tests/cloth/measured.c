/* SPDX-License-Identifier: Apache-2.0 */
/* Measured tensions: the law of their pieces, a sheet's tests in warp, weft and
 * bias, what is refused, and steps of every method. spec/cloth/cloth.md §9 */
#include "ref/cloth/measured.h"

#include "ref/cloth/advance.h"
#include "ref/cloth/law.h"
#include "ref/cloth/table.h"
#include "tests/cloth/sheet.h"

/* A fabric that is soft at first and then stiff, more so in warp, and soft in
 * bias; N/m. The weft also softens once. */
static const double warp[][2] = {
    {0.005, 3}, {0.01, 8}, {0.02, 25}, {0.03, 60}, {0.05, 150}};
static const double weft[][2] = {
    {0.01, 5}, {0.02, 16}, {0.03, 24}, {0.06, 90}, {0.1, 260}};
static const double bias[][2] = {
    {0.01, 2}, {0.03, 7}, {0.06, 18}, {0.1, 40}, {0.15, 90}};

enum { POINTS = 5 };

static void set_tables(drape_material *a)
{
    memset(a->table, 0, sizeof a->table);
    memcpy(a->table[DRAPE_WARP], warp, sizeof warp);
    memcpy(a->table[DRAPE_WEFT], weft, sizeof weft);
    memcpy(a->table[DRAPE_BIAS], bias, sizeof bias);
}

/* A sheet with these tables; across: a cell's height by its width. */
static drape_cloth measured_sheet(int m, int n, double across)
{
    drape_cloth d = sheet_default(m, n);
    d.material.stretch = 400;
    d.material.shear = 60;
    d.width = 0.02 * (m - 1);
    d.height = 0.02 * across * (n - 1);
    set_tables(&d.material);
    return d;
}

/* §9.5: energy, tension and slope belong together at one length, and are the
 * oracle's. */
static const char *check_at(const struct law *a, const struct piece *t,
                            double length)
{
    double h = 1e-6 * (double)a->rest, size = (double)a->stiff, u = 8 * REAL_U;
    double pull = law_oracle(a, t, length);
    double work = law_oracle_energy(a, t, length + h) -
                  law_oracle_energy(a, t, length - h);
    EXPECT(fabs(work / (2 * h) - pull) <= size * h + 1e-8 * fabs(pull));
    real l = (real)length;
    double is = (double)law_tension(a, t, l), near = u * size * length;
    double e = (double)law_energy(a, t, l), steep = (double)law_slope(a, t, l);
    EXPECT(fabs(is - law_oracle(a, t, (double)l)) <= near + u * fabs(pull));
    EXPECT(fabs(e - law_oracle_energy(a, t, (double)l)) <=
           u * (e + fabs(pull) * length) + near * (double)a->rest * u);
    /* blocks.md §2: T' ≥ T/ℓ, and neither exceeds the bound. */
    EXPECT(steep >= is / length * (1 - u));
    EXPECT(steep <= size * (1 + u) && is / length <= size);
    return NULL;
}

/* §9.5: the law of every direction, below, at and beyond its points, also with
 * a limit, is continuous and grows; below the rest length no bit differs. */
const char *test_measured_law(void)
{
    for (int k = 0; k < 4; k++) {
        drape_cloth d = measured_sheet(3, 3, k % 2 ? 1.4 : 1);
        struct cloth c, plain;
        d.material.limit[0] = d.material.limit[2] = k > 1 ? 0.04 : 0;
        EXPECT(ref_cloth_size(&d, &c) == DRAPE_OK);
        memset(d.material.table, 0, sizeof d.material.table);
        EXPECT(ref_cloth_size(&d, &plain) == DRAPE_OK && !plain.pieces);
        for (int o = 0; o < SPRINGS_SINGLE; o++) {
            const struct law *a = &c.law[o];
            double last = -INFINITY;
            EXPECT(a->pieces == POINTS && a->from == a->rest);
            for (int i = 0; i <= 4000; i++) {
                double length = (double)a->rest * (0.9 + 0.3 * i / 4000);
                const char *bad = check_at(a, c.piece, length);
                if (bad)
                    return bad;
                real l = (real)length;
                EXPECT((double)law_tension(a, c.piece, l) >= last);
                last = (double)law_tension(a, c.piece, l);
                if (length > (double)a->rest)
                    continue;
                EXPECT(law_tension(a, c.piece, l) ==
                       law_tension(&plain.law[o], plain.piece, l));
                EXPECT(law_slope(a, c.piece, l) ==
                       law_slope(&plain.law[o], plain.piece, l));
                EXPECT(law_energy(a, c.piece, l) ==
                       law_energy(&plain.law[o], plain.piece, l));
            }
            ran(1);
        }
    }
    return NULL;
}

/* The energy by area of a sheet's inner cell that is stretched by l along a
 * direction, and by m across, and so by no angle between them. */
static double stretched(const struct cloth *c, double angle, double l, double m)
{
    double hu = (double)c->hu, hv = (double)c->hv, e = 0;
    double way[SPRINGS_SINGLE][2] = {{hu, 0}, {0, hv}, {hu, hv}, {-hu, hv}};
    for (int o = 0; o < SPRINGS_SINGLE; o++) {
        double a = way[o][0] * cos(angle) + way[o][1] * sin(angle);
        double b = way[o][1] * cos(angle) - way[o][0] * sin(angle);
        e += law_oracle_energy(&c->law[o], c->piece, hypot(l * a, m * b));
    }
    return e / (hu * hv);
}

/* The tension of a strip whose sides are free, N/m: the derivative of the least
 * energy, found by a search that knows nothing of forces. */
static double least(const struct cloth *c, double angle, double l)
{
    double lo = 0.5, hi = 1.1;
    for (int k = 0; k < 80; k++) {
        double a = lo + (hi - lo) / 3, b = hi - (hi - lo) / 3;
        if (stretched(c, angle, l, a) < stretched(c, angle, l, b))
            hi = b;
        else
            lo = a;
    }
    return stretched(c, angle, l, (lo + hi) / 2);
}

/* §9.1: at each point of its tables a strip has the measured tension, whatever
 * the shape and the size of cells. */
const char *test_measured_strip(void)
{
    static const double shape[] = {1, 0.8, 1.3}, size[] = {1, 100, 1e-3};
    const double angle[] = {0, acos(-1) / 2, acos(-1) / 4};
    for (int k = 0; k < 9; k++) {
        drape_cloth d = measured_sheet(5, 4, shape[k % 3]);
        struct cloth c;
        d.width *= size[k / 3];
        d.height *= size[k / 3];
        EXPECT(ref_cloth_size(&d, &c) == DRAPE_OK);
        for (int o = 0; o < DRAPE_TABLES; o++)
            for (int i = 0; i < POINTS; i++) {
                const double *at = d.material.table[o][i];
                double h = 1e-6, l = 1 + at[0];
                /* The law has a corner at a point: each side has its slope. */
                double f = least(&c, angle[o], l);
                double up = least(&c, angle[o], l + h) - f;
                double down = f - least(&c, angle[o], l - h);
                EXPECT(fabs((up + down) / (2 * h) / at[1] - 1) <= 2e-3);
                ran(1);
            }
    }
    return NULL;
}

/* Whether a sheet's laws are refused, for this reason and at this place. */
static bool refused(const drape_cloth *d, enum misfit_kind kind, int table,
                    int point, double *least)
{
    struct cloth c;
    int status = ref_cloth_size(d, &c);
    *least = c.misfit.least;
    ran(1);
    return status == DRAPE_EARG && c.misfit.kind == kind &&
           (int)c.misfit.table == table && c.misfit.point == point;
}

/* §9.4: tables for which there are no laws are refused, and the point is named.
 */
const char *test_measured_refused(void)
{
    struct cloth c;
    double least;
    drape_cloth d = measured_sheet(5, 5, 1);
    d.bending = DRAPE_SPRINGS;
    EXPECT(refused(&d, MISFIT_BENDING, DRAPE_WARP, 0, &least));
    d = measured_sheet(5, 5, 1);
    d.material.table[DRAPE_WEFT][3][1] = 24; /* no growth at all */
    EXPECT(refused(&d, MISFIT_SOFT, DRAPE_WEFT, 3, &least));
    EXPECT(least > 24 && least < 48);
    /* What is named as the least is enough, and a little less is not. */
    d.material.table[DRAPE_WEFT][3][1] = least * 0.999;
    EXPECT(refused(&d, MISFIT_SOFT, DRAPE_WEFT, 3, &(double){0}));
    d.material.table[DRAPE_WEFT][3][1] = least * 1.001;
    EXPECT(ref_cloth_size(&d, &c) == DRAPE_OK && !c.misfit.kind);
    /* Shear that alone is stiffer than the bias. */
    d = measured_sheet(5, 5, 1);
    d.material.shear = 200;
    d.material.table[DRAPE_BIAS][0][1] = 1;
    EXPECT(refused(&d, MISFIT_SOFT, DRAPE_BIAS, 0, &least) && least > 1);
    /* Cells that are too oblong are so with tables, too. */
    d = measured_sheet(5, 5, 5);
    d.material.shear = 200;
    EXPECT(refused(&d, MISFIT_OBLONG, 0, 0, &least));
    return NULL;
}

/* §9.4: steps of a strain of 1e-6, up to the largest force, still give numbers
 * that are finite. */
const char *test_measured_extreme(void)
{
    struct cloth c;
    drape_cloth d = measured_sheet(3, 3, 1);
    memset(d.material.table, 0, sizeof d.material.table);
    double(*table)[2] = d.material.table[DRAPE_WARP];
    for (int k = 0; k < DRAPE_POINTS; k++) {
        table[k][0] = 1.1 * TABLE_STEP * (k + 1);
        table[k][1] = TABLE_FORCE * (k + 1) / DRAPE_POINTS;
    }
    EXPECT(table_fault((const double(*)[2])table) < 0);
    EXPECT(ref_cloth_size(&d, &c) == DRAPE_OK);
    const struct law *a = &c.law[DRAPE_WARP];
    for (int k = 0; k < 200; k++) {
        real l = a->rest * (1 + (real)(k * 1e-7));
        EXPECT(isfinite(law_tension(a, c.piece, l)));
        EXPECT(law_slope(a, c.piece, l) <= a->stiff && isfinite(a->stiff));
        EXPECT(isfinite(law_energy(a, c.piece, l)));
        ran(1);
    }
    return NULL;
}

/* Without its tables a material is the linear one; a table of the linear law's
 * own tension gives its laws back. */
const char *test_measured_linear(void)
{
    drape_cloth d = sheet_default(5, 5);
    struct cloth c, plain;
    d.material.stretch = 1000;
    d.material.shear = 300;
    EXPECT(ref_cloth_size(&d, &plain) == DRAPE_OK);
    /* §4: E = 910 in warp and weft for strains near 0 */
    for (int o = 0; o < DRAPE_BIAS; o++) {
        d.material.table[o][0][0] = 1e-5;
        d.material.table[o][0][1] = 910 * 1e-5;
    }
    EXPECT(ref_cloth_size(&d, &c) == DRAPE_OK);
    for (int o = 0; o < SPRINGS_SINGLE; o++) {
        real l = c.law[o].rest * R(1.05);
        double is = (double)law_tension(&c.law[o], c.piece, l);
        double was = (double)law_tension(&plain.law[o], plain.piece, l);
        EXPECT(fabs(is / was - 1) <= 1e-4);
        ran(1);
    }
    return NULL;
}

/* A sheet that hangs by an edge along the weft and there bears 59 N/m: beyond
 * three points of the table. */
static int make_hung(struct sheet *s, int method)
{
    static drape_pin pins[4];
    drape_cloth d = measured_sheet(4, 7, 1);
    d.material.density = 50;
    d.material.damping = 5e-3;
    d.v[1] = -1;
    for (int i = 0; i < 4; i++)
        pins[i] = (drape_pin){i, 0, -1};
    d.pins = pins;
    d.n_pins = 4;
    int status = sheet_make(s, &d, method);
    s->d.gravity = vec_make(0, R(-9.81), 0);
    return status;
}

/* The stretch at which a strip in weft has a tension, N/m: with free sides, or
 * with sides that keep their distance. */
static double stretch_by(const struct cloth *c, double tension, bool sides)
{
    double lo = 1, hi = 1.2, angle = acos(-1) / 2, h = 1e-6;
    for (int k = 0; k < 60; k++) {
        double l = (lo + hi) / 2;
        double rise = sides ? least(c, angle, l + h) - least(c, angle, l - h)
                            : stretched(c, angle, l + h, 1) -
                                  stretched(c, angle, l - h, 1);
        if (rise / (2 * h) < tension)
            lo = l;
        else
            hi = l;
    }
    return lo;
}

/* How far below its pins row `row` of the hung sheet is: each row of cells
 * bears the weight below its middle. */
static double hung_length(const struct sheet *s, int row, bool sides)
{
    double h = (double)s->c.hv, sum = 0;
    for (int j = 0; j < row; j++)
        sum += h * stretch_by(&s->c, 50 * 9.81 * (6 - j - 0.5) * h, sides);
    return sum;
}

/* Every method takes such a sheet to the same rest: it is as long as a strip
 * with free sides, but for the pins, which keep its upper edge from narrowing.
 * No energy appears on the way. */
const char *test_measured_steps(void)
{
    double way[DRAPE_BDF2 + 1];
    for (int method = DRAPE_EULER; method <= DRAPE_BDF2; method++) {
        struct sheet s;
        EXPECT(make_hung(&s, method) == DRAPE_OK);
        double start[3], dt = method < DRAPE_BW ? 1.0 / 240 : 1.0 / 60;
        s.d.dt = dt;
        sheet_energy(&s, s.x, s.v, start);
        for (int step = 0; step * dt < 1.5; step++) {
            EXPECT(sheet_step(&s) == DRAPE_OK && !s.d.outcome);
            double sum = s.d.energy[0] + s.d.energy[1] + s.d.energy[2];
            double scale = s.d.energy[0] + s.d.energy[1] + 1e-3;
            EXPECT(sum <= start[2] + 0.01 * scale);
        }
        EXPECT(s.d.energy[0] <= 1e-3 * s.d.energy[1]);
        way[method] = (double)s.x[5 * 4 + 2].y;
        EXPECT(fabs(way[method] / way[0] - 1) <= 2e-3);
        double want = hung_length(&s, 5, true);
        double narrowed = want - hung_length(&s, 5, false);
        EXPECT(fabs(-way[method] - want) <= narrowed);
        sheet_free(&s);
        ran(1);
    }
    return NULL;
}
