/* SPDX-License-Identifier: Apache-2.0 */
/* The heavy elastica, by shooting. spec/validation.md §2 */
#include "ci/validate/validate.h"

#include <math.h>

/* Length 1, u from the free end: φ, how far the strip is from straight down,
 * has φ'' = Γ u sin φ from φ(0) = rest, φ'(0) = 0, by the classical Runge–Kutta
 * method. Returns φ at the clamp, and the tip's distance and drop. */
static double shoot(double gamma, double rest, double tip[2])
{
    enum { STEPS = 2000 };
    double d = 1.0 / STEPS, y[4] = {rest, 0, 0, 0};
    for (int k = 0; k < STEPS; k++) {
        double slope[4][4];
        for (int r = 0; r < 4; r++) {
            double at[4], part = r == 0 ? 0 : r == 3 ? d : d / 2;
            for (int c = 0; c < 4; c++)
                at[c] = y[c] + (r ? part * slope[r - 1][c] : 0);
            slope[r][0] = at[1];
            slope[r][1] = gamma * (k * d + part) * sin(at[0]);
            slope[r][2] = sin(at[0]);
            slope[r][3] = cos(at[0]);
        }
        for (int c = 0; c < 4; c++)
            y[c] +=
                d / 6 *
                (slope[0][c] + 2 * slope[1][c] + 2 * slope[2][c] + slope[3][c]);
    }
    tip[0] = y[2];
    tip[1] = y[3];
    return y[0];
}

double elastica(double gamma)
{
    /* φ at the clamp is π/2 for one start alone: a smaller one does not reach
     * it, and beyond it φ swings about π with less and less amplitude. */
    double lo = 0, hi = acos(-1) / 2, tip[2] = {0, 0};
    for (int k = 0; k < 200; k++) {
        double rest = (lo + hi) / 2;
        if (shoot(gamma, rest, tip) < acos(-1) / 2)
            lo = rest;
        else
            hi = rest;
    }
    shoot(gamma, (lo + hi) / 2, tip);
    return tip[1] / tip[0];
}
