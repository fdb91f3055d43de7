/* SPDX-License-Identifier: Apache-2.0 */
/* Two rectangles that are sewn along an edge, for tests of seams. */
#ifndef TESTS_SEWN_H
#define TESTS_SEWN_H

#include "tests/base/harness.h"

enum { SEWN_SIDE = 41 };
enum { BALL_ROUND = 20, BALL_RINGS = 12 };
enum { BALL_SIDE = BALL_ROUND * BALL_RINGS };

/* Edge j = n - 1 of the first cloth is sewn to edge j = 0 of the second. */
struct sewn {
    drape_def def;
    drape_cloth cloth[2];
    drape_seam seam;
    int32_t particle[SEWN_SIDE], onto[SEWN_SIDE][2];
    double part[SEWN_SIDE];
    drape_pin pin[2 * SEWN_SIDE];
    drape_obstacle ball;
    double ball_x[BALL_SIDE][3];
    int32_t ball_tri[2 * BALL_SIDE][3];
};

/* Rectangles of `width` along i, and half of `height` along j, with m and m2
 * particles along i and cells that are as square as can be. They hang down from
 * y = 0, or lie flat; `apart`: m, the gap between them. */
void sewn_make(struct sewn *s, const int m[2], const double size[2], bool hangs,
               double apart);
/* Puts a ball of this radius, m, at the origin. Its poles are open. */
void sewn_add_ball(struct sewn *s, double radius);
/* Pins the particles (i, j) of cloth k with j as given. motion: as a pin's. */
void sewn_pin_row(struct sewn *s, int k, int j, int motion);
/* The largest distance of a gap from its target, in cells. target: NULL: 0. */
double sewn_gap(const struct sewn *s, const drape_world *world,
                const double (*target)[3]);
/* Σ pull. */
void sewn_pull(const struct sewn *s, const drape_world *world, double pull[3]);

#endif
