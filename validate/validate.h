/* SPDX-License-Identifier: Apache-2.0 */
/* What cloth does, against theory and published figures: the parts of
 * build/validate. Each property is measured at several sizes (of cells, or of
 * steps where time is the question) through the public API alone.
 * spec/validation.md */
#ifndef VALIDATE_VALIDATE_H
#define VALIDATE_VALIDATE_H

#include <drape.h>
#include <stdbool.h>
#include <stdio.h>

enum { SIZES = 4 };

struct validate {
    FILE *values;              /* csv: a row a value */
    FILE *properties;          /* csv: a row a property, in all sizes */
    int backend;               /* enum drape_backend */
    int bits;                  /* of a number in the state */
    bool quick, fine;          /* a small form, for make check; 1 mm in §6 */
    int passed, failed, known; /* known: not promised, and not met */
};

/* A property at several sizes, the coarsest first. */
struct property {
    const char *part, *name, *unit;
    double theory; /* NAN: none is known, the change by size is judged */
    double bar;    /* the error that is allowed: by `share` of theory, or in
                      the unit. NAN: nothing is judged */
    bool share;
    double up_to;  /* the bar holds for sizes up to this; 0: the finest */
    bool promised; /* a value beyond the bar is a failure */
    int count;
    double size[SIZES], value[SIZES]; /* size: m of a cell, or s of a step */
};

/* Adds a value at a size. NAN: there is none, since no state was accepted; that
 * meets no bar. */
void property_add(struct property *p, double size, double value);
/* Judges the property, writes its rows and counts it. */
void property_end(struct validate *v, const struct property *p);

/* Memory, zeroed, or the end of the program. */
void *take(size_t count, size_t size);

/* One cloth with memory of its own for what it points to. */
struct sheet {
    drape_def def;
    drape_cloth cloth;
    double (*x)[3];
    double (*v)[3];
    uint8_t *hole;
    drape_pin *pin;
    int64_t n;
};
/* m × n particles in square cells of side h, flat in the plane of x and y, j
 * along -y; without collisions, sleep and slices. */
void sheet_make(const struct validate *v, struct sheet *s, int m, int n,
                double h);
/* Turns it to the plane of x and z: gravity then pulls across. */
void sheet_lay(struct sheet *s);
void sheet_pin(struct sheet *s, int i, int j);
void sheet_free(struct sheet *s);
/* A world of the sheet as it stands; NULL after a line on standard error. */
drape_world *sheet_world(const struct sheet *s, double dt);
/* The largest quotient of friction and normal force of a contact in the last
 * step, where the normal force is not mere rounding; `before` at least. */
double sheet_steepest(drape_world *world, double before);
/* The elastic energy of the sheet as it stands, J; NAN after a fault. */
double sheet_energy(const struct sheet *s);

/* Moves the sheet to equilibrium: implicit steps that grow from 1/60 s, or from
 * 1/200 s where these find none, or from `shortest` where the start is near,
 * until one of 1 s, which is nearly a step of Newton's method, moves no
 * particle by more than `still` m. False: not found, and x is the last state.
 */
bool sheet_rest(struct sheet *s, double still);
bool sheet_rest_from(struct sheet *s, double shortest, double still);

/* The heavy elastica: tip's drop over its distance for Γ = w L³ / D. */
double elastica(double gamma);

void part_cantilever(struct validate *v);
void part_cylinder(struct validate *v);
void part_plane(struct validate *v);
void part_tension(struct validate *v);
void part_measured(struct validate *v);
void part_motion(struct validate *v);
void part_cusick(struct validate *v);
void part_fabrics(struct validate *v);
void part_buckling(struct validate *v);
void part_bendtwist(struct validate *v);
void part_stickslip(struct validate *v);
void part_hung(struct validate *v);
void part_contact(struct validate *v);
void part_ball(struct validate *v);
void part_statue(struct validate *v);
void part_meeting(struct validate *v);
void part_layers(struct validate *v);
void part_grip(struct validate *v);
void part_belt(struct validate *v);
void part_impact(struct validate *v);
void part_converge(struct validate *v);

#endif
