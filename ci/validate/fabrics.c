/* SPDX-License-Identifier: Apache-2.0 */
/* Each fabric's drape coefficient, bending length and shear beside what drape
 * tests find. spec/validation.md §7 */
#include "ci/validate/cusick.h"

#include <math.h>
#include <string.h>

static const struct fabric {
    const char *name;
    double density, stretch, shear, bend;
} fabrics[] = {
#define FABRIC(name_, density_, stretch_, shear_, bend_, thickness_,           \
               friction_, what_, source_)                                      \
    {name_, density_, stretch_, shear_, bend_},
#include "app/fabrics.def"
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

void part_fabrics(struct validate *v)
{
    if (v->quick || v->bits == 32)
        return;
    for (int k = 0; k < FABRICS; k++) {
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
        drape_row(v, f);
    }
}
