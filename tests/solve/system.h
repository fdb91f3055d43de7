/* SPDX-License-Identifier: Apache-2.0 */
/* Systems for the tests of the linear solver: from a stream of choices, and
 * from cloths in named shapes. */
#ifndef TESTS_SYSTEM_H
#define TESTS_SYSTEM_H

#include "ref/cloth/blocks.h"
#include "ref/solve/matrix.h"
#include "tests/base/harness.h"

struct system {
    int32_t m, n;
    int64_t count, n_extra, n_blocks;
    real *mass;
    sym *extra, *block;
    struct thin *thin; /* [n_blocks] of the blocks */
    uint8_t *fixed;
    vec *b; /* momentum of a falling, stretched cloth over one step */

    /* What make_system made the blocks of; pick_system leaves them alone. */
    struct law law[SPRINGS];
    uint8_t *springs;
    vec *x;
    real tau;
};

/* Gives a stage of the solver the system's grid, masses and blocks. */
#define GIVE_SYSTEM(stage, system)                                             \
    do {                                                                       \
        (stage)->m = (system)->m;                                              \
        (stage)->n = (system)->n;                                              \
        (stage)->count = (system)->count;                                      \
        (stage)->mass = (system)->mass;                                        \
        (stage)->n_extra = (system)->n_extra;                                  \
        (stage)->extra = (system)->extra;                                      \
        (stage)->n_blocks = (system)->n_blocks;                                \
        (stage)->block = (system)->block;                                      \
    } while (0)

/* A small system: any shape of grid, blocks vvᵀ or zero, holes and pins. */
void pick_system(struct bytes *b, struct system *s);

enum shape {
    SHAPE_FLAT,      /* in a coordinate plane */
    SHAPE_TILTED,    /* flat, oblique to the axes */
    SHAPE_STRETCHED, /* by 5 % and 2 %, sheared */
    SHAPE_WRINKLED,  /* waves of slope up to 0.4 */
    SHAPE_FOLDED,    /* zigzag folds past the vertical, uneven */
    SHAPE_DRAPED,    /* crossing folds, some springs long, some short */
    SHAPES
};

enum trim {
    TRIM_NONE = 0,
    TRIM_HOLE = 1,  /* a round hole in the middle */
    TRIM_CUT = 2,   /* no springs across most of the middle line */
    TRIM_MOTHS = 4, /* one particle in 50 is missing */
    TRIM_PINS = 8,  /* two corners and one particle in 200 are pinned */
    TRIM_SLIT = 16  /* a column of missing particles */
};

struct design {
    int32_t m, n;
    enum shape shape;
    int trim;      /* or of enum trim */
    double uneven; /* random displacement, as a share of the cell */
};

/* A cloth of cotton, longest side 1 m, dt = 1/60; memory from malloc. */
void make_system(const struct design *design, struct system *s);
/* Contacts hold one particle in `every`, about as penalty.md does, and only
 * they push: the right-hand side is theirs. */
void hold_system(struct system *a, uint32_t every);
/* The stage that made its blocks. */
struct blocks blocks_of(const struct system *s);
void free_system(struct system *s);

/* What a thin block is, rounded. */
sym thin_sym(struct thin t);

/* Block (p, q) of the dense matrix, by the definition of matrix.md §2. */
mat dense_entry(const struct system *s, int64_t p, int64_t q);

/* A uniform number in [-1, 1) that depends on k alone. */
double noise_of(uint64_t k);

#endif
