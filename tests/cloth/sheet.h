/* SPDX-License-Identifier: Apache-2.0 */
/* A cloth with its streams that is stepped without contact, the force law of
 * the arc itself as an oracle, and random grids of springs for generators. */
#ifndef TESTS_SHEET_H
#define TESTS_SHEET_H

#include "ref/cloth/dynamics.h"
#include "tests/base/harness.h"

struct sheet {
    struct cloth c;
    struct dynamics d;
    vec *x, *v, *xp, *vp, *to;
    double *dense; /* scratch of sheet_solve, [15·count] */
    void *memory[24];
    int n_memory;
};

/* A cloth of a plain material: 1 m × 1 m, no holes, no pins, no damping. */
drape_cloth sheet_default(int m, int n);
/* Allocates and fills all streams. There is no wind and no gravity; dt is 1/60
 * s; BDF2 solves its equation far. Returns a status of the library. */
int sheet_make(struct sheet *s, const drape_cloth *def, int method);
void sheet_free(struct sheet *s);
/* Runs one step. If it neither fails nor diverges, x, v, xp and vp move on to
 * its end. */
int sheet_step(struct sheet *s);
/* The function `solve` of struct dynamics: plain conjugate gradients in
 * binary64, to a relative residual of 1e-13. */
int sheet_solve(struct dynamics *d);
/* Computes the forces f at x, v, without wind. */
void sheet_force(const struct sheet *s, const vec *x, const vec *v, vec *f);
/* Computes the kinetic, elastic and gravitational energy, J, at x, v. */
void sheet_energy(const struct sheet *s, const vec *x, const vec *v,
                  double energy[3]);

/* REAL_U: unit roundoff. LAW_ERROR: relative error of the fit of cloth.md §5;
 * LAW_SLOPE_ERROR: absolute error of the fit's slope. */
#define REAL_U (REAL_BITS == 32 ? 0x1p-24 : 0x1p-53)
#define LAW_ERROR 2.5e-7
#define LAW_SLOPE_ERROR 1.6e-3
/* The force law with the arc itself in place of the fit: tension, slope and
 * energy of a spring, in binary64. */
double law_oracle(const struct law *a, const struct piece *t, double length);
double law_oracle_slope(const struct law *a, const struct piece *t,
                        double length);
double law_oracle_energy(const struct law *a, const struct piece *t,
                         double length);

/* A random grid of about pick_size() particles, with springs that stay within
 * it. */
struct grid {
    int32_t m, n;
    int64_t count;
    struct law *law;
    int64_t pieces;
    struct piece *piece;
    int64_t triples, n_beside;
    real *triple;
    uint8_t *springs, *beside, *cell, *fixed;
    real *mass;
};
struct grid pick_grid(struct bytes *b);
/* The same, sometimes with limits, measured tensions or triples. */
struct grid pick_bent_grid(struct bytes *b);
/* Gives a stage the grid's springs and triples. */
#define GIVE_GRID(stage, grid)                                                 \
    do {                                                                       \
        (stage)->laws = SPRINGS;                                               \
        (stage)->law = (grid)->law;                                            \
        (stage)->pieces = (grid)->pieces;                                      \
        (stage)->piece = (grid)->piece;                                        \
        (stage)->springs = (grid)->springs;                                    \
        (stage)->triples = (grid)->triples;                                    \
        (stage)->triple = (grid)->triple;                                      \
        (stage)->n_beside = (grid)->n_beside;                                  \
        (stage)->beside = (grid)->beside;                                      \
    } while (0)
/* Returns positions [count] near the grid's rest shape; some are coincident or
 * far away. */
vec *pick_state(struct bytes *b, const struct grid *g);
/* Returns vectors [count] with components within ±scale. */
vec *pick_vecs(struct bytes *b, int64_t count, real scale);

#endif
