/* SPDX-License-Identifier: Apache-2.0 */
/* Linear systems for the tests of the solver: from a stream of choices, or of a
 * cloth in one of several shapes. */
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
    struct packed *packed; /* [n_blocks] the blocks in 64 bits */
    uint8_t *fixed;
    vec *b;      /* momentum of a falling, stretched cloth over one step */
    int triples; /* 1: some blocks are of triples, A ≤ 3·diagonal */

    /* The cloth, positions and τ from which make_system made the blocks;
     * pick_system does not set them. */
    struct cloth cloth;
    vec *x;
    real tau;
};

/* Sets a stage's grid, masses, extra and blocks to those of the system. */
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

/* Chooses a system: a grid of any shape, blocks v vᵀ or 0, sometimes triples,
 * holes and pins. */
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
    TRIM_CUT = 2,   /* a column of missing cells along most of the middle */
    TRIM_MOTHS = 4, /* one particle in 50 is missing */
    TRIM_PINS = 8,  /* two corners and one particle in 200 are pinned */
    TRIM_SLIT = 16  /* a column of missing particles */
};

struct design {
    int32_t m, n;
    enum shape shape;
    int trim;      /* a bitwise or of enum trim */
    double uneven; /* random displacement, as a share of the cell */
    int bending;   /* enum drape_bending */
};

/* Makes the system of a cloth of default cotton whose longest side is 1 m, at
 * rest in the shape, for dt = 1/60 s. free_system frees its memory. */
void make_system(const struct design *design, struct system *s);
/* Adds contacts that hold one particle in `every`, about as stiff as a contact
 * may be (carry.md §1.2). The right-hand side is then only the push of the
 * contacts. */
void hold_system(struct system *a, uint32_t every);
/* Returns the stage blocks that makes the system's blocks. */
struct blocks blocks_of(const struct system *s);
void free_system(struct system *s);

/* The 3 × 3 block that a packed block encodes, rounded to the precision. */
sym packed_sym(struct packed t);

/* Block (p, q) of the dense matrix, by the definition in matrix.md §2. */
mat dense_entry(const struct system *s, int64_t p, int64_t q);

/* A number in [-1, 1), uniform over k, that depends on k alone. */
double noise_of(uint64_t k);

#endif
