/* SPDX-License-Identifier: Apache-2.0 */
/* Bending by triples: energies of cylinders and of plane strains against the
 * continuum's. spec/cloth/cloth.md §4, §7 */
#include "ref/cloth/triple.h"

#include "tests/cloth/sheet.h"

/* The places of a particle's neighbours on a cylinder that is bent by `bow` in
 * the direction (c, s) of the rest plane: the arc keeps its length. */
static void rolled(double bow, double c, double s, double u, double v,
                   double x[3])
{
    double along = c * u + s * v, across = c * v - s * u, angle = bow * along;
    x[0] = sin(angle) / bow;
    x[1] = across;
    x[2] = (1 - cos(angle)) / bow;
}

/* The energy by area of the triples of an inner particle of that cylinder. */
static double density(const struct cloth *a, double bow, double c, double s)
{
    double sum = 0, hu = (double)a->hu, hv = (double)a->hv;
    for (int o = 0; o < SPRINGS_SINGLE; o++) {
        double u = spring_di[o] * hu, v = spring_dj[o] * hv;
        double before[3], after[3], square = 0;
        rolled(bow, c, s, -u, -v, before);
        rolled(bow, c, s, u, v, after);
        for (int k = 0; k < 3; k++)
            square += (before[k] + after[k]) * (before[k] + after[k]);
        sum += (double)triple_constant(a->triple, o, 15) * square;
    }
    return sum / 2 / (hu * hv);
}

/* cloth.md §7: on square cells a cylinder has the energy ½ bend κ² by area in
 * every direction and at every size of cells; on others along both axes. The
 * error of a triple is (κL)²/12 of it, L its single spring's length. */
const char *test_triples_cylinder(void)
{
    static const double ratio[] = {1, 0.8, 1.3};
    const double bow = 10;
    for (int k = 0; k < 12; k++) {
        drape_cloth d = sheet_default(2, 2);
        struct cloth a;
        d.width = 5e-3 / (1 << k / 3);
        d.height = d.width * ratio[k % 3];
        EXPECT(ref_cloth_size(&d, &a) == DRAPE_OK);
        double want = d.material.bend * bow * bow / 2;
        double reach = bow * (d.width + d.height);
        for (int turn = 0; turn <= 12; turn++) {
            double way = turn * 3.1415926535897932 / 12;
            double is = density(&a, bow, cos(way), sin(way));
            EXPECT((k % 3 && turn % 6) ||
                   fabs(is / want - 1) <= reach * reach / 12 + 20 * REAL_U);
        }
        ran(1);
    }
    return NULL;
}

/* cloth.md §7: a whole sheet that is bent along u has the same energy up to its
 * borders along u, where there are no triples for half a cell each. */
const char *test_triples_border(void)
{
    const double bow = 5;
    for (int n = 5; n <= 20; n += 5) {
        drape_cloth d = sheet_default(2 * n, n);
        double x[3], energy[3], h = 0.01;
        struct sheet s;
        d.width = (2 * n - 1) * h;
        d.height = (n - 1) * h;
        EXPECT(sheet_make(&s, &d, DRAPE_BW) == DRAPE_OK);
        for (int64_t p = 0; p < s.c.count; p++) {
            rolled(bow, 1, 0, h * (double)(p % d.m), h * (double)(p / d.m), x);
            s.x[p] = vec_make((real)x[0], (real)x[1], (real)x[2]);
        }
        for (int o = 0; o < SPRINGS; o++)
            s.c.law[o].k = s.c.law[o].compression = 0;
        sheet_energy(&s, s.x, s.v, energy);
        sheet_free(&s);
        double area = (d.width - h) * d.height;
        double want = d.material.bend * bow * bow / 2 * area;
        EXPECT(fabs(energy[1] / want - 1) <=
               (REAL_BITS == 32 ? 2e-3 : 0) + bow * bow * h * h / 6);
        ran(1);
    }
    return NULL;
}

/* cloth.md §4: the energy of a whole sheet in a uniform strain is that of the
 * material, borders included, by moduli that do not depend on `bend`. Springs
 * have a cubic term, hence a relative error of about the strain. */
const char *test_triples_plane(void)
{
    static const double strain[][3] = {{1, 0, 0},  {0, 1, 0}, {1, 1, 0},
                                       {-1, 0, 0}, {0, 0, 1}, {1, -1, 1}};
    double e = REAL_BITS == 32 ? 1e-2 : 1e-5;
    for (int k = 0; k < 12; k++) {
        drape_cloth d = sheet_default(4, 5);
        double energy[3], h = 0.1, g = k % 2 ? 0.12 : 0.1;
        const double *a = strain[k / 2];
        double eu = e * a[0], ev = e * a[1], half = e * a[2] / 2;
        struct sheet s;
        d.width = 3 * h;
        d.height = 4 * g;
        d.material.bend = k % 4 / 2 ? 1e-12 : 0;
        EXPECT(sheet_make(&s, &d, DRAPE_BW) == DRAPE_OK);
        for (int64_t p = 0; p < s.c.count; p++) {
            double u = h * (double)(p % d.m), v = g * (double)(p / d.m);
            s.x[p] = vec_make((real)(u * (1 + eu) + half * v),
                              (real)(v * (1 + ev) + half * u), 0);
        }
        sheet_energy(&s, s.x, s.v, energy);
        sheet_free(&s);
        double c11 = d.material.stretch, c66 = d.material.shear;
        double want = c11 * (eu * eu + ev * ev) / 2 + c66 * eu * ev +
                      c66 * 2 * half * half;
        want *= d.width * d.height;
        EXPECT(fabs(energy[1] / want - 1) <= 4 * e + 1e3 * REAL_U / e);
        ran(1);
    }
    return NULL;
}

/* The sum of the absolute values in row p of the matrix of all triples, which
 * is found from forces alone: those of a sheet whose springs have no force,
 * with one particle at a time moved by 1 m. */
static void triple_rows(struct sheet *s, double *row)
{
    for (int o = 0; o < SPRINGS; o++)
        s->c.law[o].k = s->c.law[o].compression = 0;
    memset(s->x, 0, (size_t)s->c.count * sizeof *s->x);
    for (int64_t q = 0; q < s->c.count; q++) {
        s->x[q].y = 1;
        sheet_force(s, s->x, s->v, s->d.x1);
        s->x[q].y = 0;
        for (int64_t p = 0; p < s->c.count; p++)
            row[p] += fabs((double)s->d.x1[p].y);
    }
}

/* cloth.md §6: the bound is the largest row of the matrix by the row's mass,
 * where a spring counts with stiff at both of its ends. */
static const char *check_bound(const drape_cloth *d)
{
    double row[36] = {0}, want = 0;
    struct sheet s;
    EXPECT(sheet_make(&s, d, DRAPE_BW) == DRAPE_OK && s.c.count <= 36);
    for (int64_t p = 0; p < s.c.count; p++)
        for (int o = 0; o < SPRINGS; o++)
            if (s.c.springs[p] >> o & 1) {
                row[p] += 2 * (double)s.c.law[o].stiff;
                row[p + spring_di[o] + d->m * spring_dj[o]] +=
                    2 * (double)s.c.law[o].stiff;
            }
    triple_rows(&s, row);
    for (int64_t p = 0; p < s.c.count; p++)
        if (!s.c.fixed[p] && row[p] > want * (double)s.c.mass[p])
            want = row[p] / (double)s.c.mass[p];
    double bound = s.c.bound;
    sheet_free(&s);
    EXPECT(want > 0 && fabs(bound / want - 1) <= 64 * REAL_U);
    return NULL;
}

const char *test_triples_bound(void)
{
    const char *failed = NULL;
    unsigned state = 5;
    for (int k = 0; k < 200 && !failed; k++) {
        uint8_t cut[36];
        drape_cloth d = sheet_default(3 + k % 4, 3 + k / 4 % 4);
        for (int p = 0; p < 36; p++) {
            state = state * 1664525u + 1013904223u;
            cut[p] = p > 0 && (state >> 24 & 7) == 0;
        }
        d.cut = k % 3 ? cut : NULL;
        d.width = 0.1 * (d.m - 1);
        d.height = 0.12 * (d.n - 1);
        d.material.stretch =
            k % 2 ? 1e-3 : 10; /* springs count little, or as */
        d.material.shear = d.material.stretch / 3; /* much as triples */
        d.material.bend = 0.1;
        failed = check_bound(&d);
        ran(1);
    }
    return failed;
}
