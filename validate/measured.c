/* SPDX-License-Identifier: Apache-2.0 */
/* A strip of a fabric by its measured tensions: its strain at rest where it
 * hangs by its end. spec/validation.md §4 */
#include "validate/validate.h"

#include <math.h>

static const double length = 0.3, wide = 0.1;

/* Jet-set of Wang, O'Brien and Ramamoorthi 2011, by enum drape_table: the
 * stiffnesses C11, C12, C22, N/m, with 1 along the direction, at rest and at a
 * strain of a sixth. */
static const struct direction {
    const char *name;
    double rest[3], strained[3];
} jet_set[] = {{"warp", {43.07, 54.37, 171.42}, {75.15, 82.20, 236.16}},
               {"weft", {171.42, 54.37, 43.07}, {404.87, -21.87, 227.03}}};

/* The tension of a strip with free sides at strain e: the stiffness, linear in
 * e, by Green's strain, times 1 + e, as it is by the width at rest. */
static double tension_at(const struct direction *a, double e)
{
    double c[3];
    for (int k = 0; k < 3; k++)
        c[k] = a->rest[k] + 6 * e * (a->strained[k] - a->rest[k]);
    return (1 + e) * (c[0] - c[1] * c[1] / c[2]) * (e + e * e / 2);
}

/* Tables with points at strains of k/90. */
static void set_tables(drape_material *m)
{
    m->stretch = 240;
    m->shear = 7.16;
    m->bend = 1.96e-5;
    for (int o = DRAPE_WARP; o <= DRAPE_WEFT; o++)
        for (int k = 1; k <= 15; k++) {
            m->table[o][k - 1][0] = k / 90.0;
            m->table[o][k - 1][1] = tension_at(&jet_set[o], k / 90.0);
        }
}

/* The strain in the middle row of cells of a strip along u or v that hangs in
 * so many rows, an odd number. This row bears the weight below its middle:
 * `load` N/m. NAN: no rest was found. */
static double hung_strain(const struct validate *v, int along, int rows,
                          double load)
{
    struct sheet s;
    double h = length / rows;
    int across = (int)(wide / h + 0.5) + 1;
    int m = along == 0 ? rows + 1 : across, n = along == 0 ? across : rows + 1;
    int step = along == 0 ? 1 : m, side = along == 0 ? m : 1;
    sheet_make(v, &s, m, n, h);
    set_tables(&s.cloth.material);
    s.cloth.material.density = load / (length / 2) / 9.81;
    if (along == 0) {
        s.def.gravity[0] = 9.81;
        s.def.gravity[1] = 0;
    }
    for (int k = 0; k < across; k++)
        sheet_pin(&s, along == 0 ? 0 : k, along == 0 ? k : 0);
    s.def.newton = 8;
    bool found = sheet_rest(&s, v->bits == 64 ? 1e-9 : 1e-6);
    const double *upper = s.x[across / 2 * side + rows / 2 * step];
    double strain = fabs(upper[3 * step + along] - upper[along]) / h - 1;
    sheet_free(&s);
    return found ? strain : NAN;
}

void part_measured(struct validate *v)
{
    static const int rows[SIZES] = {9, 15, 31, 61};
    static const double strain[] = {0.02, 0.05, 0.12};
    for (int o = DRAPE_WARP; o <= DRAPE_WEFT; o++)
        for (int k = 0; k < 3; k++) {
            char name[96];
            double load = tension_at(&jet_set[o], strain[k]);
            snprintf(name, sizeof name,
                     "strain of a hanging strip in %s; at %.3g N/m",
                     jet_set[o].name, load);
            struct property p = {.part = "measured",
                                 .name = name,
                                 .unit = "1",
                                 .theory = strain[k],
                                 .bar = 0.02,
                                 .share = true,
                                 .promised = true};
            for (int c = 0; c < (v->quick ? 2 : SIZES); c++)
                property_add(&p, length / rows[c],
                             hung_strain(v, o, rows[c], load));
            property_end(v, &p);
        }
}
