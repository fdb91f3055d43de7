/* SPDX-License-Identifier: Apache-2.0 */
/* Boundary-value problems of thin strips by shooting: the classical
 * Runge–Kutta method, and Newton's method for what is not known at the start.
 * spec/validation.md §2, §10 to §12 */
#include "validate/shooting.h"

#include <math.h>

void runge_kutta(const struct ode *e, const void *user, double *y)
{
    double d = 1.0 / e->steps;
    for (int k = 0; k < e->steps; k++) {
        double slope[4][ODE_MOST], at[ODE_MOST];
        for (int r = 0; r < 4; r++) {
            double part = r == 0 ? 0 : r == 3 ? d : d / 2;
            for (int c = 0; c < e->n; c++)
                at[c] = y[c] + (r ? part * slope[r - 1][c] : 0);
            e->slope(user, k * d + part, at, slope[r]);
        }
        for (int c = 0; c < e->n; c++)
            y[c] +=
                d / 6 *
                (slope[0][c] + 2 * slope[1][c] + 2 * slope[2][c] + slope[3][c]);
    }
}

/* Solves a x = b, which become their factors and x, by elimination with
 * pivots. */
static void eliminate(int n, double a[SHOOT_MOST][SHOOT_MOST], double *b)
{
    for (int k = 0; k < n; k++) {
        int best = k;
        for (int r = k + 1; r < n; r++)
            best = fabs(a[r][k]) > fabs(a[best][k]) ? r : best;
        for (int c = 0; c < n; c++) {
            double swap = a[k][c];
            a[k][c] = a[best][c];
            a[best][c] = swap;
        }
        double swap = b[k];
        b[k] = b[best];
        b[best] = swap;
        for (int r = 0; r < n; r++) {
            double part = r == k ? 0 : a[r][k] / a[k][k];
            for (int c = k; c < n; c++)
                a[r][c] -= part * a[k][c];
            b[r] -= part * b[k];
        }
    }
    for (int k = 0; k < n; k++)
        b[k] /= a[k][k];
}

bool shoot(int n, double *unknown, shot *miss, const void *user)
{
    for (int turn = 0; turn < 50; turn++) {
        double b[SHOOT_MOST], a[SHOOT_MOST][SHOOT_MOST], most = 0;
        miss(user, unknown, b);
        for (int c = 0; c < n; c++) {
            double keep = unknown[c], moved[SHOOT_MOST];
            double step = 1e-6 * (1 + fabs(keep));
            unknown[c] = keep + step;
            miss(user, unknown, moved);
            unknown[c] = keep;
            for (int r = 0; r < n; r++)
                a[r][c] = (moved[r] - b[r]) / step;
        }
        for (int r = 0; r < n; r++)
            most = fmax(most, fabs(b[r]));
        if (most < 1e-10)
            return true;
        eliminate(n, a, b);
        for (int c = 0; c < n; c++)
            unknown[c] -= b[c];
    }
    return false;
}
