/* SPDX-License-Identifier: Apache-2.0 */
/* Each fabric's drape coefficient, bending length and shear beside what drape
 * tests find. spec/validation.md §7 */
#include "validate/cusick.h"

#include <math.h>
#include <string.h>

static const struct fabric {
    const char *name;
    double density, stretch, shear, bend;
} fabrics[] = {
#define FABRIC(name_, density_, stretch_, shear_, bend_, thickness_,           \
               friction_, what_, source_)                                      \
    {name_, density_, stretch_, shear_, bend_},
#include "app/scene/fabrics.def"
#undef FABRIC
};
enum { FABRICS = sizeof fabrics / sizeof *fabrics };

/* Published bands of the drape coefficient, %; the middle and half the width of
 * a band are theory and bar of the row. */
static const struct band {
    const char *name;
    double low, high;
} bands[] = {
    {"silk", 20, 40}, {"cotton", 60, 76}, {"wool", 40, 70}, {"denim", 70, 90}};

static void drape_row(struct validate *v, const struct fabric *f)
{
    static const double cell[SIZES] = {12e-3, 8e-3, 6e-3, 4e-3};
    drape_cloth cloth;
    drape_default_cloth(&cloth);
    cloth.material.density = f->density;
    cloth.material.stretch = f->stretch;
    cloth.material.shear = f->shear;
    cloth.material.bend = f->bend;
    struct drape d = cusick(v, &cloth.material, cell, SIZES);
    char name[96];
    snprintf(name, sizeof name, "drape coefficient; %s", f->name);
    struct property p = {.part = "fabrics",
                         .name = name,
                         .unit = "%",
                         .theory = NAN,
                         .bar = NAN};
    for (int k = 0; k < 4; k++)
        if (!strcmp(bands[k].name, f->name)) {
            p.theory = (bands[k].low + bands[k].high) / 2;
            p.bar = (bands[k].high - bands[k].low) / 2;
        }
    for (int k = 0; k < SIZES; k++)
        property_add(&p, cell[k], d.percent[k]);
    property_end(v, &p);
    snprintf(name, sizeof name, "folds; %s", f->name);
    struct property folds = {.part = "fabrics",
                             .name = name,
                             .unit = "1",
                             .theory = NAN,
                             .bar = NAN};
    for (int k = 0; k < SIZES; k++)
        property_add(&folds, cell[k], d.folds[k]);
    property_end(v, &folds);
}

/* The angle below the level, degrees, at which a ribbon in warp of twice
 * Peirce's bending length hangs: the test of BS 3356 cuts its strip so that
 * this is 41.5. Two rows are pinned, as in cantilever.c. */
static double hang(const struct validate *v, const struct fabric *f, int cells)
{
    struct sheet s;
    double length = 2 * cbrt(f->bend / (9.81 * f->density));
    double h = length / (cells - 0.5);
    sheet_make(v, &s, cells + 1, 2, h);
    s.cloth.material.density = f->density;
    s.cloth.material.stretch = f->stretch;
    s.cloth.material.shear = f->shear;
    s.cloth.material.bend = f->bend;
    sheet_lay(&s);
    for (int k = 0; k < 4; k++)
        sheet_pin(&s, k % 2, k / 2);
    bool found = sheet_rest(&s, 1e-7 * length);
    double angle = atan2(-s.x[cells][1], s.x[cells][0] - h / 2);
    sheet_free(&s);
    return found ? angle * 180 / acos(-1) : NAN;
}

/* The shear modulus, N/m: of the energy of a sheet sheared by 0.1 %. */
static double shear_of(const struct validate *v, const struct fabric *f,
                       double h)
{
    struct sheet s;
    const double angle = 1e-3;
    sheet_make(v, &s, 11, 11, h);
    s.cloth.material.stretch = f->stretch;
    s.cloth.material.shear = f->shear;
    s.cloth.material.bend = f->bend;
    for (int p = 0; p < s.n; p++) {
        double x = s.x[p][0], y = s.x[p][1];
        s.x[p][0] = x + angle / 2 * y;
        s.x[p][1] = y + angle / 2 * x;
    }
    double area = 100 * h * h;
    double modulus = 2 * sheet_energy(&s) / (area * angle * angle);
    sheet_free(&s);
    return modulus;
}

static void strip_rows(struct validate *v, const struct fabric *f)
{
    static const int cells[SIZES] = {8, 12, 25, 50};
    static const double cell[SIZES] = {12e-3, 8e-3, 6e-3, 4e-3};
    char name[2][96];
    snprintf(name[0], sizeof name[0],
             "angle at twice Peirce's bending length; %s", f->name);
    snprintf(name[1], sizeof name[1], "shear modulus at 0.1 %%; %s", f->name);
    struct property p[2] = {
        {.unit = "degrees", .theory = atan(elastica(8)) * 180 / acos(-1)},
        {.unit = "N/m", .theory = f->shear}};
    double length = 2 * cbrt(f->bend / (9.81 * f->density));
    for (int q = 0; q < 2; q++) {
        p[q].part = "fabrics";
        p[q].name = name[q];
        p[q].bar = q ? 0.005 : 0.01;
        p[q].share = p[q].promised = true;
    }
    for (int k = 0; k < (v->quick ? 2 : SIZES); k++) {
        property_add(&p[0], length / cells[k], hang(v, f, cells[k]));
        property_add(&p[1], cell[k], shear_of(v, f, cell[k]));
    }
    property_end(v, &p[0]);
    property_end(v, &p[1]);
}

void part_fabrics(struct validate *v)
{
    if (v->bits == 32)
        return;
    for (int k = 0; k < (v->quick ? 1 : FABRICS); k++) {
        char name[96];
        const struct fabric *f = &fabrics[k];
        snprintf(name, sizeof name, "Peirce's bending length; %s", f->name);
        struct property p = {.part = "fabrics",
                             .name = name,
                             .unit = "mm",
                             .theory = NAN,
                             .bar = NAN};
        property_add(&p, 0, 1e3 * cbrt(f->bend / (9.81 * f->density)));
        property_end(v, &p);
        strip_rows(v, f);
        if (!v->quick)
            drape_row(v, f);
    }
}
