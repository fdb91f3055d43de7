/* SPDX-License-Identifier: Apache-2.0 */
/* The cloth model: a grid of particles, cells and springs, and a material
 * turned into spring constants. spec/cloth/cloth.md */
#ifndef REF_CLOTH_H
#define REF_CLOTH_H

#include "ref/base/stage.h"

/* The eight forward directions; the backward eight are their negatives. */
enum { SPRINGS = 8, SPRINGS_SINGLE = 4 };
static const int8_t spring_di[SPRINGS] = {1, 0, 1, -1, 2, 0, 2, -2};
static const int8_t spring_dj[SPRINGS] = {0, 1, 1, 1, 0, 2, 2, 2};

/* Why a particle has no freedom; 0: it has. */
enum { CLOTH_PINNED = 1, CLOTH_ABSENT = 2 };

/* One direction's springs, §4: linear in tension, linear in compression down
 * to the knee, buckled below it. Single springs have their knee at 0. */
struct law {
    real k;     /* N/m, along the spring, in tension */
    real press; /* N/m, in compression: c_b of a double spring */
    real rest;  /* m, > 0 */
    real knee;  /* m, 0 … rest */
    real bend;  /* N, k_b / rest² of a double spring; 0 for a single one */
    real damp;  /* N·s/m, along the spring */
    real stiff; /* N/m, no slope of the tension exceeds it, §5 */
    real well;  /* J, so that the energy is continuous at the knee */
};

struct cloth {
    int32_t m, n;        /* particles along i and j */
    int64_t count;       /* m·n */
    int64_t n_triangles; /* two a present cell */
    real hu, hv;         /* m, cell at rest */
    real cell_mass;      /* kg */
    real beta;           /* s, damping / stiffness */
    struct law law[SPRINGS];
    double bound;     /* out: 1/s², on the eigenvalues of M⁻¹K, §6 */
    int64_t n_pinned; /* out: particles */

    uint8_t *cell;     /* out: [count] 1: the cell with lower corner p is */
    uint8_t *springs;  /* out: [count] bit o: forward spring o is */
    uint8_t *fixed;    /* out: [count] 0, CLOTH_PINNED or CLOTH_ABSENT */
    real *mass;        /* out: [count] kg; 0 for absent particles */
    int32_t (*tri)[3]; /* out: [n_triangles] scene vertices */
};

/* The coordinate j of particle p. */
static inline int32_t cloth_row(int64_t p, int32_t m)
{
    return (int32_t)(p / m);
}

/* First of two calls: sizes and laws. DRAPE_OK, or DRAPE_EARG if the cells
 * are too oblong for the shear stiffness (§4). def is checked but for that. */
int ref_cloth_size(const drape_cloth *def, struct cloth *c);

/* Second call: fills the streams that the caller gave; base is the scene's
 * number of particle 0. DRAPE_OK, or DRAPE_EARG if an absent particle is
 * pinned. */
int ref_cloth_fill(const drape_cloth *def, struct cloth *c, int64_t base);

/* The start state: x, v [count]. DRAPE_OK, or DRAPE_EDATA if a position or
 * velocity leaves ±2^60. */
int ref_cloth_start(const drape_cloth *def, vec *x, vec *v);

#endif
