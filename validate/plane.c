/* SPDX-License-Identifier: Apache-2.0 */
/* Moduli in the plane: of the energy of uniform strains, in any direction, and
 * of a strip that hangs by one end. spec/validation.md §4 */
#include "validate/validate.h"

#include <math.h>

/* Energy by area of a sheet of 0.1 m in a uniform deformation F. */
static double density(const struct validate *v, double h, double f[2][2])
{
    struct sheet s;
    int n = (int)(0.1 / h + 0.5);
    sheet_make(v, &s, n + 1, n + 1, h);
    for (int64_t p = 0; p < s.n; p++) {
        double a = h * (double)(p % (n + 1)), b = h * (double)(p / (n + 1));
        s.x[p][0] = f[0][0] * a + f[0][1] * b;
        s.x[p][1] = f[1][0] * a + f[1][1] * b;
    }
    double energy = sheet_energy(&s);
    sheet_free(&s);
    return energy / (n * h * n * h);
}

/* Energy by area where the sheet is `along` longer in the direction `way` and
 * `across` wider. */
static double stretched(const struct validate *v, double h, double way,
                        double along, double across)
{
    double c = cos(way), s = sin(way);
    double f[2][2] = {
        {1 + along * c * c + across * s * s, (along - across) * c * s},
        {(along - across) * c * s, 1 + along * s * s + across * c * c}};
    return density(v, h, f);
}

/* Young's modulus and Poisson's ratio of W = ½ (a ε² + 2 b ε ν' + c ν'²), ν'
 * the strain across, where ν' is free. Strains of both signs cancel the cubic
 * terms. */
static void moduli(const struct validate *v, double h, double way, double e,
                   double out[2])
{
    double w[3] = {0, 0, 0};
    for (int sign = -1; sign <= 1; sign += 2) {
        double d = sign * e;
        w[0] += stretched(v, h, way, d, 0) / (e * e);
        w[1] += stretched(v, h, way, 0, d) / (e * e);
        w[2] += stretched(v, h, way, d, d) / (e * e);
    }
    double a = w[0], c = w[1], b = (w[2] - w[0] - w[1]) / 2;
    out[0] = a - b * b / c;
    out[1] = b / c;
}

static double shear(const struct validate *v, double h, double angle)
{
    double f[2][2] = {{1, angle}, {0, 1}};
    return 2 * density(v, h, f) / (angle * angle);
}

static const double cell[SIZES] = {0.02, 0.01, 0.005, 0.0025};

/* What §4 of cloth.md gives in a direction: with C11 = C22 = stretch, C12 = C66
 * = shear, as a plane's tensor turned by the angle. */
static void theory(double way, double out[2])
{
    double c = pow(cos(way), 2), s = pow(sin(way), 2);
    double c11 = 1000, c66 = 300;
    double a = c11 * (c * c + s * s) + 6 * c66 * c * s;
    double b = (c11 - 3 * c66) * 2 * c * s + c66;
    out[0] = a - b * b / a;
    out[1] = b / a;
}

void part_plane(struct validate *v)
{
    static const struct way {
        const char *name;
        double degrees;
    } ways[] = {{"warp", 0}, {"weft", 90}, {"bias", 45}};
    static const double angle[] = {0.001, 0.01, 0.1};
    double e = v->bits == 64 ? 1e-3 : 1e-2;
    for (int k = 0; k < 6; k++) {
        const struct way *w = &ways[k / 2];
        double way = w->degrees * acos(-1) / 180, due[2], is[2];
        char name[96];
        snprintf(name, sizeof name, "%s in %s; strain %g %%",
                 k % 2 ? "Poisson's ratio" : "Young's modulus", w->name,
                 100 * e);
        theory(way, due);
        struct property p = {.part = "plane",
                             .name = name,
                             .unit = k % 2 ? "1" : "N/m",
                             .theory = due[k % 2],
                             .bar = 0.005,
                             .share = true,
                             .promised = true,
                             .up_to = 1};
        for (int c = 0; c < (v->quick ? 2 : SIZES); c++) {
            moduli(v, cell[c], way, e, is);
            property_add(&p, cell[c], is[k % 2]);
        }
        property_end(v, &p);
    }
    for (int k = v->bits == 64 ? 0 : 1; k < 3; k++) {
        char name[96];
        snprintf(name, sizeof name, "shear modulus at %g %%", 100 * angle[k]);
        struct property p = {.part = "plane",
                             .name = name,
                             .unit = "N/m",
                             .theory = 300,
                             .bar = k ? 0.02 : 0.005,
                             .share = true,
                             .promised = true,
                             .up_to = 1};
        for (int c = 0; c < (v->quick ? 2 : SIZES); c++)
            property_add(&p, cell[c], shear(v, cell[c], angle[k]));
        property_end(v, &p);
    }
}
