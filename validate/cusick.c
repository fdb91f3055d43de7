/* SPDX-License-Identifier: Apache-2.0 */
/* Cusick's drape test, BS 5058. spec/validation.md §6 */
#include "validate/shadow.h"

#include "validate/cusick.h"

#include <math.h>
#include <string.h>

static const double radius = 0.15, support = 0.09; /* m */

/* A flat disc of cells of side h between the plates of the support: particles
 * on it are pinned. The clamp is half a row before the last pinned one, and
 * rows are h apart along the axes and h/√2 along diagonals. */
static void disc(const struct validate *v, struct sheet *s,
                 const drape_material *material, double h)
{
    int half = (int)(radius / h) + 1, side = 2 * half + 1;
    sheet_make(v, s, side, side, h);
    sheet_lay(s);
    s->cloth.material = *material;
    s->def.tolerance = 1e-4; /* of steps towards rest */
    for (int p = 0; p < s->n; p++) {
        s->x[p][0] -= half * h;
        s->x[p][2] += half * h;
        double x = s->x[p][0], z = s->x[p][2], r = hypot(x, z);
        s->hole[p] = r > radius + h / 4;
        if (r <= support + 0.85 * h)
            sheet_pin(s, p % side, p / side);
        /* Waves of many numbers, so that no number of folds is given. */
        double turn = atan2(z, x), wave = 0;
        for (int k = 2; k < 12; k++)
            wave += cos(k * turn + k * k);
        s->x[p][1] = 2e-3 * fmax(0, r - support) * wave;
    }
}

/* Whether a particle of the coarse sheet can be taken from. */
static bool there(const struct sheet *s, int i, int j)
{
    int m = s->cloth.m;
    return i >= 0 && j >= 0 && i < m && j < s->cloth.n && !s->hole[i + m * j];
}

/* Sets the sheet as the coarser one lies: from the nearest particle there,
 * along its tangents. */
static void refine(struct sheet *s, double h, const struct sheet *coarse,
                   double g)
{
    int m = s->cloth.m, c = coarse->cloth.m;
    for (int p = 0; p < s->n; p++) {
        double u = (p % m - m / 2) * h / g + c / 2;
        double w = (p / m - m / 2) * h / g + c / 2;
        int best = -1;
        double least = INFINITY;
        for (int k = 0; k < 49; k++) {
            int i = (int)u + k % 7 - 3, j = (int)w + k / 7 - 3;
            double d = hypot(u - i, w - j);
            if (there(coarse, i, j) && d < least) {
                least = d;
                best = i + c * j;
            }
        }
        if (best < 0 || s->hole[p])
            continue;
        int i = best % c, j = best / c;
        int e = there(coarse, i + 1, j), a = there(coarse, i - 1, j);
        int n = there(coarse, i, j + 1), b = there(coarse, i, j - 1);
        for (int k = 0; k < 3; k++) {
            double du = coarse->x[best + e][k] - coarse->x[best - a][k];
            double dw = coarse->x[best + n * c][k] - coarse->x[best - b * c][k];
            s->x[p][k] = coarse->x[best][k] +
                         (e + a ? (u - i) * du / (e + a) : 0) +
                         (n + b ? (w - j) * dw / (n + b) : 0);
        }
    }
}

struct drape cusick(const struct validate *v, const drape_material *material,
                    const double *cell, int sizes)
{
    struct drape d = {.sizes = sizes};
    struct sheet last = {0};
    for (int k = 0; k < sizes; k++) {
        struct sheet s;
        disc(v, &s, material, cell[k]);
        double whole = shadow_of(&s).area;
        double plate = acos(-1) * support * support;
        if (k)
            refine(&s, cell[k], &last, cell[k - 1]);
        bool found = sheet_rest_from(&s, k ? 0.15 : 1.0 / 60,
                                     v->bits == 64 ? 2e-5 : 1e-4);
        struct shadow shadow = shadow_of(&s);
        d.percent[k] =
            found ? 100 * (shadow.area - plate) / (whole - plate) : NAN;
        d.folds[k] = found ? shadow.folds : NAN;
        if (k)
            sheet_free(&last);
        last = s;
    }
    sheet_free(&last);
    return d;
}

void part_cusick(struct validate *v)
{
    static const double usual[SIZES] = {12e-3, 8e-3, 4e-3, 3e-3};
    static const double fine[SIZES] = {8e-3, 4e-3, 2e-3, 1e-3};
    const double *cell = v->fine ? fine : usual;
    drape_cloth cloth;
    if (v->quick && v->bits == 32)
        return;
    drape_default_cloth(&cloth);
    cloth.material.density = 0.15;
    cloth.material.shear = 50;
    int sizes = v->quick ? 2 : v->bits == 64 ? SIZES : 3;
    struct drape d = cusick(v, &cloth.material, cell, sizes);
    struct property share = {.part = "cusick",
                             .name =
                                 "drape coefficient; D = 1e-5; change by cells",
                             .unit = "%",
                             .theory = NAN,
                             .bar = v->quick ? 10 : 1,
                             .promised = v->fine || v->quick};
    struct property folds = {.part = "cusick",
                             .name = "folds; D = 1e-5",
                             .unit = "1",
                             .theory = NAN,
                             .bar = NAN};
    for (int k = 0; k < sizes; k++) {
        property_add(&share, cell[k], d.percent[k]);
        property_add(&folds, cell[k], d.folds[k]);
    }
    property_end(v, &share);
    property_end(v, &folds);
}
