/* SPDX-License-Identifier: Apache-2.0 */
/* The heavy elastica, by shooting. spec/validation.md §2 */
#include "validate/shooting.h"
#include "validate/validate.h"

#include <math.h>

/* y: φ, how far the strip is from straight down, its derivative, and the tip's
 * distance and drop: φ'' = Γ u sin φ, u from the free end. */
static void slope(const void *user, double u, const double *y, double *dy)
{
    const double *gamma = user;
    dy[0] = y[1];
    dy[1] = *gamma * u * sin(y[0]);
    dy[2] = sin(y[0]);
    dy[3] = cos(y[0]);
}

/* From φ(0) = rest, φ'(0) = 0. Returns φ at the clamp. */
static double from_end(double gamma, double rest, double tip[2])
{
    static const struct ode equations = {4, 2000, slope};
    double y[4] = {rest, 0, 0, 0};
    runge_kutta(&equations, &gamma, y);
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
        if (from_end(gamma, rest, tip) < acos(-1) / 2)
            lo = rest;
        else
            hi = rest;
    }
    from_end(gamma, (lo + hi) / 2, tip);
    return tip[1] / tip[0];
}
