/* SPDX-License-Identifier: Apache-2.0 */
/* Panels for tests, cut as `drape pattern` cuts them, and their model without a
 * world. */
#ifndef TESTS_CUTTING_H
#define TESTS_CUTTING_H

#include "app/base/cut.h"
#include "ref/panel/panel.h"
#include "tests/base/harness.h"

/* A panel that was cut, and a cloth of it: square cells, flat in the plane of x
 * and y at its places at rest, of sheet_default's material. */
struct cutting {
    struct curve edge[8];
    struct outline outline;
    struct cut cut;
    drape_panel panel;
    double (*rest)[2];
    drape_cloth cloth;
    const uint8_t *hinged; /* as panel_make takes it; NULL */
};

/* Cuts a strip that is turned by `turn` radians against the grid, or a disc.
 * false: it cannot be cut. cutting_free gives back what it holds. */
bool cutting_strip(struct cutting *c, double length, double width, double turn,
                   double h);
bool cutting_disc(struct cutting *c, double radius, double h);
void cutting_free(struct cutting *c);

/* The model of a cutting's cloth, and a state of it. */
struct model {
    struct arena arena;
    struct cloth c;
    double (*rest)[2]; /* [count] of the cutting */
    vec *x, *v, *f;    /* [count] */
    sym *block;        /* [SPRINGS·count] */
    real *chunk;
};

/* Makes the model at rest. Returns a status of the library. */
int model_make(struct model *s, const struct cutting *c);
void model_free(struct model *s);
/* Sets f to the forces at x, which damp at v if that is not NULL. */
void model_force(struct model *s, const vec *v);
/* Returns the elastic energy at x, J. */
double model_energy(struct model *s);
/* Sets block to the matrix for steps of tau s. */
void model_blocks(struct model *s, double tau);
/* Whether all cells at a particle are there, so that it is not on the border.
 */
bool model_is_inner(const struct cutting *c, int64_t p);
/* The area of all cells, m². */
double model_area(const struct cutting *c);

#endif
