/* SPDX-License-Identifier: Apache-2.0 */
/* A slender strip that bends and twists by its weight, and the same as a rod.
 * spec/validation.md §10, §11 */
#include "validate/ribbon.h"

#include "validate/shooting.h"

#include <math.h>
#include <string.h>

/* Kirchhoff's rod, which bends and twists at once. Of length 1 and stiffness 1
 * against bending of its surface, clamped level along x. */
struct rod {
    double edge;   /* stiffness against bending in its plane */
    double twist;  /* stiffness against twist */
    double roll;   /* of the clamp about x, from lying flat, radian */
    double weight; /* w W L³ by that stiffness */
};

/* The load of the increment, and the rod. */
struct loaded {
    const struct rod *rod;
    double weight;
};

static void cross(const double *a, const double *b, double *out)
{
    for (int c = 0; c < 3; c++)
        out[c] =
            a[(c + 1) % 3] * b[(c + 2) % 3] - a[(c + 2) % 3] * b[(c + 1) % 3];
}

static double dot(const double *a, const double *b)
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* y: place, tangent, normal of the surface, moment that the part beyond s
 * exerts. The frame turns by the moment over the stiffnesses, and the moment
 * falls by the tangent times the weight of the part beyond. */
static void slope(const void *user, double s, const double *y, double *dy)
{
    const struct loaded *l = user;
    const double *tangent = y + 3, *normal = y + 6, *moment = y + 9;
    double across[3], turn[3], force[3] = {0, -l->weight * (1 - s), 0};
    cross(tangent, normal, across);
    for (int c = 0; c < 3; c++)
        turn[c] = dot(moment, across) * across[c] +
                  dot(moment, normal) / l->rod->edge * normal[c] +
                  dot(moment, tangent) / l->rod->twist * tangent[c];
    memcpy(dy, tangent, 3 * sizeof *dy);
    cross(turn, tangent, dy + 3);
    cross(turn, normal, dy + 6);
    cross(force, tangent, dy + 9);
}

static const struct ode equations = {12, 400, slope};

static void from_clamp(const struct loaded *l, const double *moment, double *y)
{
    double roll = l->rod->roll;
    const double start[9] = {0, 0, 0, 1, 0, 0, 0, cos(roll), sin(roll)};
    memcpy(y, start, sizeof start);
    memcpy(y + 9, moment, 3 * sizeof *y);
    runge_kutta(&equations, l, y);
}

/* At the free end there is no moment. */
static void free_end(const void *user, const double *moment, double *miss)
{
    double y[12];
    from_clamp(user, moment, y);
    memcpy(miss, y + 9, 3 * sizeof *miss);
}

/* Where its free end hangs, y upward; false: no equilibrium was found. */
static bool rod_tip(const struct rod *r, double tip[3])
{
    enum { INCREMENTS = 40 };
    double moment[3] = {0, 0, 0}, y[12];
    struct loaded l = {r, 0};
    for (int k = 1; k <= INCREMENTS; k++) {
        l.weight = r->weight * k / INCREMENTS;
        if (!shoot(3, moment, free_end, &l))
            return false;
    }
    from_clamp(&l, moment, y);
    memcpy(tip, y, 3 * sizeof *tip);
    return true;
}

enum { SLENDER = 20 }; /* length over width */

static const double stiffness = 1e-4, weight = 0.2 * 9.81; /* N·m, N/m² */
static const double young = 910;     /* N/m, along the warp: §4 */
static const double third = 1.0 / 3; /* Poisson's ratio for bending */

double ribbon_length(const struct ribbon *r)
{
    return cbrt(r->gamma * stiffness / weight);
}

/* A strip whose sides are free bends with D (1 − ν²) a width and is twisted
 * with 2 D (1 − ν); in its plane it bends as a beam as deep as it is wide. */
void ribbon_rod(const struct ribbon *r, double tip[2])
{
    double wide = ribbon_length(r) / SLENDER, soft = 1 - third * third;
    struct rod rod = {.edge = young * wide * wide / 12 / (soft * stiffness),
                      .twist = 2 * (1 - third) / soft,
                      .roll = r->roll,
                      .weight = r->gamma / soft};
    double end[3];
    bool found = rod_tip(&rod, end);
    tip[0] = found ? -end[1] : NAN;
    tip[1] = found ? fabs(end[2]) : NAN;
}

/* Two columns are pinned, so the clamp is half a cell before the second one.
 * The sheet stands in the plane of x and y, and gravity is turned. */
void ribbon_sheet(const struct validate *v, const struct ribbon *r, int across,
                  double tip[2])
{
    struct sheet s;
    double length = ribbon_length(r);
    double down[3] = {0, -sin(r->roll), -cos(r->roll)}, mean[3] = {0, 0, 0};
    int along = SLENDER * across;
    double h = length / (along - 0.5);
    sheet_make(v, &s, along + 1, across + 1, h);
    s.cloth.material.bend = stiffness;
    s.def.max_iterations = 20000;
    for (int c = 0; c < 3; c++)
        s.def.gravity[c] = 9.81 * down[c];
    for (int j = 0; j <= across; j++) {
        sheet_pin(&s, 0, j);
        sheet_pin(&s, 1, j);
    }
    bool found = sheet_rest(&s, (v->bits == 64 ? 1e-8 : 1e-5) * length);
    for (int j = 0; j <= across; j++)
        for (int c = 0; c < 3; c++) {
            double start = c == 1 ? -h * j : 0;
            const double *x = s.x[along + (along + 1) * j];
            mean[c] += (x[c] - start) / (across + 1);
        }
    sheet_free(&s);
    tip[0] = found ? mean[1] * down[1] + mean[2] * down[2] : NAN;
    tip[1] = found ? fabs(mean[1] * down[2] - mean[2] * down[1]) : NAN;
    tip[0] /= length;
    tip[1] /= length;
}
