/* SPDX-License-Identifier: Apache-2.0 */
/* Shooting for boundary-value problems of thin strips. validate/shooting.c
 */
#ifndef VALIDATE_SHOOTING_H
#define VALIDATE_SHOOTING_H

#include <stdbool.h>

enum { ODE_MOST = 12, SHOOT_MOST = 3 };

/* n equations y' = slope(s, y) for s from 0 to 1, in so many steps. */
struct ode {
    int n, steps;
    void (*slope)(const void *user, double s, const double *y, double *dy);
};
/* Takes y from s = 0 to s = 1. */
void runge_kutta(const struct ode *e, const void *user, double *y);

/* By how much the conditions at s = 1 are missed from a start. */
typedef void shot(const void *user, const double *unknown, double *miss);
/* Moves n unknowns to where nothing is missed. False: not found. */
bool shoot(int n, double *unknown, shot *miss, const void *user);

#endif
