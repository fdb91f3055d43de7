/* SPDX-License-Identifier: Apache-2.0 */
/* The panels of a sewing pattern, cut: app/patterns/README.md. */
#ifndef APP_SCENE_GARMENT_H
#define APP_SCENE_GARMENT_H

#include "app/base/cut.h"
#include "app/read/pattern.h"

struct garment_panel {
    const struct pattern_panel *panel;
    int edges;           /* of the outline, without those that are closed up */
    struct curve *curve; /* [edges] counter-clockwise */
    int *number;         /* [edges] the file's */
    struct outline outline;
    struct cut cut;
    struct outline_pair strap, gap; /* the narrowest; width INFINITY: none */
    double shift[3]; /* m, from where the pattern places it: garment_part */
    struct garment_roll {
        double radius;          /* m; 0: the panel is flat */
        double at[2], along[2]; /* m; unit: the line that stays where it is */
    } roll;                     /* garment_roll_up */
};

struct garment {
    const struct pattern *pattern;
    struct pool pool;            /* of curves and numbers */
    double h;                    /* m, side of a cell */
    struct garment_panel *panel; /* [pattern->panels] */
};

/* Cuts all panels. Returns app_exit; a failure prints one line, and what will
 * be less exact than the outline prints a note each. The caller uses
 * garment_free in any case; the pattern must live as long. */
int garment_cut(struct garment *garment, const struct pattern *pattern,
                double h);
void garment_free(struct garment *garment);

/* The edge of a panel by its place in the outline, and the particles at its two
 * ends; false where they are one, so that it has no length. */
bool garment_ends(const struct garment_panel *panel, int place, int32_t end[2]);
/* The number of border particles on each edge of a panel, its ends among
 * them. count: [edges] in the file's order */
void garment_count(const struct garment_panel *panel, int *count);
/* Lengths of a stitch's sides by the pattern, m. */
void garment_lengths(const struct pattern *pattern,
                     const struct pattern_stitch *stitch, double length[2]);
/* Finds the points of a stitch; `seam` has none where an edge is too short for
 * cells. Returns app_exit, and cut_seam_free gives back what it holds. */
int garment_seam(const struct garment *garment,
                 const struct pattern_stitch *stitch, struct cut_seam *seam);
/* Whether side 1 of a stitch runs against its outline, if side 0 runs along. */
bool garment_runs_back(const struct garment *garment,
                       const struct pattern_stitch *stitch);
/* Which stitches go across the end of another one, as a collar does across
 * that of a shoulder seam: where three corners meet that are sewn to each
 * other, those of the widest corner. across: [stitches]. Returns app_exit. */
int garment_across(const struct garment *garment, bool *across);

/* Whether a stitch closes a tube: its sides are of one rolled panel, or of two
 * that face each other, so that it is drawn together along their normals. */
bool garment_is_around(const struct garment *garment,
                       const struct pattern_stitch *stitch,
                       const struct cut_seam *seam);
/* Whether a stitch closes a dart: its edges are of one panel and meet. */
bool garment_is_dart(const struct pattern *pattern,
                     const struct pattern_stitch *stitch);
/* The greatest distance of two places that are sewn together, where the pattern
 * places them, m. */
double garment_gap(const struct garment *garment,
                   const struct pattern_stitch *stitch,
                   const struct cut_seam *seam);
/* The place in a panel's outline of an edge by its number; -1: closed up. */
int garment_find_edge(const struct garment_panel *panel, int edge);
/* Whether the file goes round a panel clockwise, as its edge 0 does: then its
 * right side is at -z. */
bool garment_is_clockwise(const struct pattern_panel *panel);
/* Where a point of a panel starts, m: rolled, placed and shifted. */
void garment_stand(const struct garment_panel *panel, const double x[2],
                   double out[3]);
/* Rolls each panel that a stitch makes a tube, as a sleeve of one panel, about
 * its wrong side, so that a tenth of the tube is open. */
void garment_roll_up(struct garment *garment);
/* Moves panels that lie in one plane and touch apart, and prints a note of
 * each two. */
void garment_part(struct garment *garment);

#endif
