/* SPDX-License-Identifier: Apache-2.0 */
/* Cuts a panel: lays a closed outline on a grid of square cells, and moves the
 * particles beside the outline onto it. Pure geometry, of an outline and the
 * cells' side alone: app/patterns/README.md §4 to §7. */
#ifndef APP_BASE_CUT_H
#define APP_BASE_CUT_H

#include "app/base/outline.h"

/* Corners of a cell are counted counter-clockwise from its least i and j. */
enum cut_cell {
    CUT_ABSENT,
    CUT_REGULAR, /* all corners are where the grid has them */
    CUT_RISING,  /* a corner was moved; divided from corner 0 to 2 */
    CUT_FALLING, /* a corner was moved; divided from corner 1 to 3 */
    CUT_WITHOUT  /* a triangle without corner `kind - CUT_WITHOUT` */
};
enum cut_particle {
    CUT_OUT,    /* there is none */
    CUT_IN,     /* inside, where the grid has it */
    CUT_BORDER, /* on the outline */
    CUT_CORNER  /* where two edges of the outline meet */
};

struct cut {
    double h, at[2]; /* m, side of a cell, and place of particle 0, 0 */
    int m, n;        /* particles along x and along y, the grain */
    double (*x)[2];  /* [m n] m, particle i + m j, at rest */
    uint8_t *kind;   /* [m n] enum cut_particle */
    int32_t *chord;  /* [m n] the chord that it lies on, or -1 */
    uint8_t *cell;   /* [(m - 1) (n - 1)] enum cut_cell */
    int32_t *corner; /* [edges] the particle where an edge begins */
    int64_t particles, borders;        /* that a cell has */
    int64_t regular, moved, triangles; /* cells */
    int64_t absent;                    /* cells */
    int64_t parted;                    /* cells of pieces that were left out */
    double area;                       /* m², of the cells */
    double off, off_dart;              /* cells: the greatest distance between
                                          the outline and the border of the
                                          cells, away from the tips of darts
                                          and beside them */
};

enum cut_status {
    CUT_OK,
    CUT_MEMORY, /* there is none */
    CUT_LARGE,  /* more than CUT_MOST particles */
    CUT_NONE,   /* no cell is inside */
    CUT_APART   /* it falls into pieces; x is in one that is left out */
};
enum { CUT_MOST = 1 << 26 };

/* Cuts the outline by cells of side h. What went well is counted in the cut,
 * which cut_free gives back. x: out: where CUT_APART is so. */
enum cut_status cut_make(struct cut *cut, const struct outline *outline,
                         double h, double x[2]);
void cut_free(struct cut *cut);

/* Whether a cell of this kind has its corner k. */
static inline bool cut_has(uint8_t cell, int k)
{
    return cell != CUT_ABSENT && cell != CUT_WITHOUT + k;
}
/* The corners of a cell, counter-clockwise: 4, 3 or, where it is absent, 0. */
int cut_corners(const struct cut *cut, int64_t cell, int32_t corner[4]);
/* The triangles of a cell: 2, 1 or 0. */
int cut_triangles(const struct cut *cut, int64_t cell, int32_t tri[2][3]);
/* Whether the edge of a cell from its corner k to the next is on the border.
 * `count` corners are there. */
bool cut_is_border(const struct cut *cut, int64_t cell, int k, int count);

/* A side of a seam: an edge of a panel that was cut. */
struct cut_side {
    const struct cut *cut;
    const struct outline *outline;
    int edge;  /* of the outline */
    bool back; /* the seam runs against the outline */
};
/* A particle that is held to a place on the other side. */
struct cut_point {
    int32_t particle;
    int32_t onto[2]; /* particles of the other side, which may be one */
    double part;   /* 0 … 1: the place is (1 - part) onto[0] + part onto[1] */
    double at;     /* 0 … 1: where on the seam */
    double length; /* m, of the seam that it stands for */
};
/* An edge of the longer side, which is sewn to less than its length. */
struct cut_ease {
    int32_t end[2];
    double ratio;
};
struct cut_seam {
    int longer; /* the side that is eased: 0 or 1 */
    int eases;
    struct cut_ease *ease; /* [eases] along the seam */
    int fine; /* the side of the particles, which are more there: 0 or 1 */
    int n;
    struct cut_point *point; /* [n] along the seam */
};
/* Finds the points of a seam, by fractions of the lengths of both sides. There
 * are none where a side has no two particles. false: no memory. cut_seam_free
 * gives back what it holds. */
bool cut_seam_make(struct cut_seam *seam, const struct cut_side side[2]);
void cut_seam_free(struct cut_seam *seam);

/* The smallest triangle, as a part of a cell's area. */
#define CUT_LEAST 0.12
/* The area of a triangle of particles as a part of a cell's. */
double cut_part(const struct cut *cut, const int32_t p[3]);
/* What is cut, and its chords by squares of about a cell. */
struct border {
    const struct outline *outline;
    struct buckets chords;
};
/* What a cell becomes of which all corners are there and some were moved:
 * divided by the diagonal whose smaller triangle is the larger; where that is
 * too small, the triangle that is the largest. */
uint8_t cut_divide(const struct cut *cut, const struct border *border,
                   const int32_t p[4]);

/* The steps of cut_make, in their order. */
void cut_snap(struct cut *cut, const struct outline *outline);
bool cut_choose(struct cut *cut, const struct border *border);
enum cut_status cut_join(struct cut *cut, double x[2]);
void cut_reach_corners(struct cut *cut, const struct border *border);
bool cut_measure(struct cut *cut, const struct border *border);

#endif
