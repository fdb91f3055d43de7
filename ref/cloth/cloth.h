/* SPDX-License-Identifier: Apache-2.0 */
/* The cloth model: a grid of particles, cells and springs, with spring
 * constants that follow from the material. spec/cloth/cloth.md */
#ifndef REF_CLOTH_H
#define REF_CLOTH_H

#include "ref/base/stage.h"

/* The eight forward directions; the backward eight are their negatives. */
enum { SPRINGS = 8, SPRINGS_SINGLE = 4 };
static const int8_t spring_di[SPRINGS] = {1, 0, 1, -1, 2, 0, 2, -2};
static const int8_t spring_dj[SPRINGS] = {0, 1, 1, 1, 0, 2, 2, 2};

/* Why a particle does not move freely; 0: the particle is free. */
enum { CLOTH_PINNED = 1, CLOTH_ABSENT = 2 };

/* §5: the force law of the springs of one direction: linear in tension, linear
 * in compression down to the knee, buckled below the knee. Single springs never
 * buckle: their knee is 0. §8: if they have a limit, their slope grows near
 * it. §9: a measured tension has straight pieces. */
struct law {
    real k;           /* N/m, along the spring, in tension */
    real compression; /* N/m, in compression: c_b of a double spring */
    real rest;        /* m, > 0 */
    real knee;        /* m, shorter springs are buckled; 0 … rest */
    real bend;  /* N, k_b / rest² of a double spring; 0 for a single one */
    real damp;  /* N·s/m, along the spring */
    real stiff; /* N/m, bound on the slope of the tension, §6 */
    real well;  /* J, makes the energy continuous at the knee */
    real from;  /* m, longer springs have more than k alone, or pieces instead
                   of k; +∞: none does */
    real limit; /* m, §8: longer springs stiffen; +∞: none does */
    real over;  /* m, the range of lengths in which the slope grows */
    real gain;  /* N/m², half the growth of the slope by length */
    int32_t pieces; /* of a measured tension; 0: k holds up to the limit */
    int32_t first;  /* the first of them */
};

/* §9: a straight piece of a measured tension. A spring longer than `from` has
 * pull + slope·(length − from), N, unless a later piece has begun. */
struct piece {
    real from;  /* m */
    real slope; /* N/m */
    real pull;  /* N, at `from` */
    real work;  /* J, at `from` */
};
/* Those of the tables in warp, weft and bias. */
enum { PIECES = (int)DRAPE_TABLES * DRAPE_POINTS };

/* Why no laws of springs give a sheet the stiffness that is asked for. */
enum misfit_kind {
    MISFIT_NONE,
    MISFIT_OBLONG,    /* of cells: §4 */
    MISFIT_BENDING,   /* a table needs bending by triples: §9.4 */
    MISFIT_UNSETTLED, /* the laws of the tables do not settle: §9.3 */
    MISFIT_SOFT       /* a table asks for too little at a point: §9.4 */
};
struct misfit {
    enum misfit_kind kind;
    enum drape_table table; /* of MISFIT_BENDING, the first that is given, and
                               of MISFIT_SOFT */
    int point;              /* of MISFIT_SOFT: of the table */
    double least;           /* likewise: N/m, the least force there that fits */
};

/* §7: bits of the cells that meet at a particle: bit di + 2·dj says that the
 * cell with lower corner (i - di, j - dj) is present, and regular in a panel.
 * BESIDE_STARS: the particle has stars in place of triples (panel.md §4). */
enum { CELL_MASKS = 32, BESIDE_STARS = 16 };
/* The constants of triples: N/m, of direction o with cells b about the middle,
 * at CELL_MASKS·o + b; 0 where these cells leave no triple. */
enum { TRIPLES = CELL_MASKS * (int)SPRINGS_SINGLE };

struct panel;

struct cloth {
    int32_t m, n;        /* particles along i and j */
    int64_t count;       /* m·n */
    int64_t n_triangles; /* two for each present cell but triangles of panels */
    real hu, hv;         /* m, sides of a cell at rest */
    real cell_mass;      /* kg, of a present cell */
    real beta;           /* s, damping / stiffness */
    struct law law[SPRINGS];
    int64_t pieces; /* PIECES, or 0: no tension was measured */
    struct piece piece[PIECES];
    struct misfit misfit; /* out: why setting the laws failed */
    int64_t triples;      /* TRIPLES, or 0: double springs resist bending */
    real triple[TRIPLES];
    double bound;     /* out: 1/s², bound of the eigenvalues of M⁻¹K, §6 */
    double damped;    /* out: 1/s², bound of those of M⁻¹C / β, §8 */
    int64_t n_pinned; /* out: pinned particles */

    uint8_t *cell;       /* out: [count] 1: cell with lower corner p is present,
                            and regular in a panel */
    uint8_t *springs;    /* out: [count] bit o: forward spring o is present */
    uint8_t *beside;     /* out: [count] bits of the cells about p */
    uint8_t *fixed;      /* out: [count] 0, CLOTH_PINNED or CLOTH_ABSENT */
    real *mass;          /* out: [count] kg; 0 for absent particles */
    int32_t (*tri)[3];   /* out: [n_triangles] scene vertices */
    struct panel *panel; /* NULL: the cloth is a rectangle */
    uint8_t *pairs; /* [count] of a panel: bit o: the matrix has a block of the
                       pair in the forward direction o; NULL: springs says so */
};

/* The bits of the pairs of particles of which the matrix has blocks. */
static inline const uint8_t *cloth_pairs(const struct cloth *c)
{
    return c->pairs ? c->pairs : c->springs;
}

/* The coordinate j of particle p. */
static inline int32_t cloth_row(int64_t p, int32_t m)
{
    return (int32_t)(p / m);
}

/* Whether direction o, forward (sign 1) or backward (sign -1), leads from (i,
 * j) to a particle within the grid. */
static inline bool spring_inside(int32_t m, int32_t n, int32_t i, int32_t j,
                                 int o, int sign)
{
    int32_t a = i + sign * spring_di[o], b = j + sign * spring_dj[o];
    return a >= 0 && a < m && b >= 0 && b < n;
}

/* How much larger than p the index of the particle at the forward end of spring
 * o of p is. */
static inline int64_t spring_step(int32_t m, int o)
{
    return spring_di[o] + (int64_t)m * spring_dj[o];
}

/* First of two calls: sets the sizes and the laws of c. Returns DRAPE_OK, or
 * DRAPE_EARG if no laws fit: `misfit` says why. Everything else in def has been
 * checked before. */
int ref_cloth_size(const drape_cloth *def, struct cloth *c);

/* Sets the laws, the triples and the mass of a cell by the sizes, the material
 * and the bending of def, as ref_cloth_size does; for a material that changes.
 * DRAPE_OK, or DRAPE_EARG as there; c may have changed then. */
int ref_cloth_laws(const drape_cloth *def, struct cloth *c);

/* Fills mass, bound and damped from the laws and from what is fixed. */
void ref_cloth_weigh(struct cloth *c);

/* Second call: fills the streams, which the caller has allocated. base: the
 * scene's index of particle 0. Returns DRAPE_OK, or DRAPE_EARG if an absent
 * particle is pinned. */
int ref_cloth_fill(const drape_cloth *def, struct cloth *c, int64_t base);

/* Writes the start state x, v [count]. Returns DRAPE_OK, or DRAPE_EDATA if a
 * coordinate or velocity is NaN or outside ±2^60. */
int ref_cloth_start(const drape_cloth *def, vec *x, vec *v);

#endif
