/* SPDX-License-Identifier: Apache-2.0 */
/* A cloth with its streams, stepped without contact, and random grids of
 * springs for generators. */
#ifndef TESTS_SHEET_H
#define TESTS_SHEET_H

#include "ref/cloth/dynamics.h"
#include "tests/base/harness.h"

struct sheet {
    struct cloth c;
    struct dynamics d;
    vec *x, *v, *xp, *vp, *to;
    double *dense; /* scratch of sheet_solve */
    void *memory[16];
    int n_memory;
};

/* A cloth of a plain material: 1 m × 1 m, no holes, no pins, no damping. */
drape_cloth sheet_default(int m, int n);
/* Allocates and fills everything; still air, no gravity, dt 1/60. */
int sheet_make(struct sheet *s, const drape_cloth *def, int method);
void sheet_free(struct sheet *s);
/* One step; x, v and the past go on where it ends well. */
int sheet_step(struct sheet *s);
/* A plain conjugate gradient in binary64, to 1e-13. */
int sheet_solve(struct dynamics *d);
/* The forces at x, v, without wind. */
void sheet_force(const struct sheet *s, const vec *x, const vec *v, vec *f);
/* Kinetic, elastic and potential energy at x, v. */
void sheet_energy(const struct sheet *s, const vec *x, const vec *v,
                  double energy[3]);

/* u of the number model; how far the fit of cloth.md §5 and its
 * slope may be off: of g, and of 1. */
#define REAL_U (REAL_BITS == 32 ? 0x1p-24 : 0x1p-53)
#define LAW_ERROR 2.5e-7
#define LAW_SLOPE_ERROR 1.6e-3
/* The force law by the arc itself: tension, slope and energy of a spring. */
double law_oracle(const struct law *a, double length);
double law_oracle_slope(const struct law *a, double length);
double law_oracle_energy(const struct law *a, double length);

/* A random grid of pick_size() particles; springs only within it. */
struct grid {
    int32_t m, n;
    int64_t count;
    struct law *law;
    uint8_t *springs, *cell, *fixed;
    real *mass;
};
struct grid pick_grid(struct bytes *b);
/* Positions near the grid's rest shape, some coincident or far. */
vec *pick_state(struct bytes *b, const struct grid *g);
/* count vectors within ±scale. */
vec *pick_vecs(struct bytes *b, int64_t count, real scale);

#endif
