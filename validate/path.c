/* SPDX-License-Identifier: Apache-2.0 */
/* The point beside a sheet, and the choice of the places where both start.
 * spec/validation.md §9 */
#include "validate/path.h"

#include <math.h>
#include <string.h>

enum { TRIES = 60 };

/* The velocity after an impulse from the ground along n, with its friction, of
 * a point that falls with this velocity without it. */
static void pushed(const double falling[3], const double n[3], double push,
                   double friction, double out[3])
{
    double along = dot3(falling, n), slip[3];
    for (int c = 0; c < 3; c++)
        slip[c] = falling[c] - along * n[c];
    double speed = sqrt(dot3(slip, slip));
    double left = speed > 0 ? fmax(0, 1 - friction * push / speed) : 0;
    for (int c = 0; c < 3; c++)
        out[c] = left * slip[c] + (along + push) * n[c];
}

bool point_step(const struct floor *f, struct point *p, double friction,
                double dt, double gap)
{
    double n[3], after[3], falling[3], v[3], x[3], push = 0;
    bool found = false;
    memcpy(falling, p->v, sizeof falling);
    falling[1] -= dt * PATH_GRAVITY;
    if (isnan(f->height(f->ground, p->x, n)))
        return false;
    /* The ground is nearly flat within a step, so the height that is missing,
     * over dt, is nearly the impulse that is missing. Where two facets meet the
     * normal may jump to and fro, and is settled after half of the tries. */
    for (int k = 0; k < TRIES && !found; k++) {
        pushed(falling, n, push, friction, v);
        for (int c = 0; c < 3; c++)
            x[c] = p->x[c] + dt * v[c];
        double height = f->height(f->ground, x, after);
        if (isnan(height))
            return false;
        if (f->ends && k < TRIES / 2)
            memcpy(n, after, sizeof n);
        double next = fmax(0, push + (gap - height) / dt);
        found = fabs(next - push) < 1e-9;
        push = next;
    }
    if (!found && !f->ends)
        return false;
    memcpy(p->x, x, sizeof x);
    memcpy(p->v, v, sizeof v);
    p->push = push;
    p->level = n[1];
    return true;
}

static double smooth_height(const void *ground, const double x[3],
                            double normal[3])
{
    return ground_height(ground, x, normal);
}

struct floor floor_smooth(const struct ground *g)
{
    return (struct floor){smooth_height, g, false};
}

/* Whether a point that starts at rest stays on the ground, on slopes of 15 to
 * 75 degrees, pressed by a quarter of its weight at least, and comes 0.1 m far.
 * way: how it went. */
static bool slides(const struct ground *g, const double start[3],
                   double friction, double way[3])
{
    const double dt = 1.0 / 480, degree = acos(-1) / 180;
    const struct floor f = floor_smooth(g);
    struct point p = {.push = 0};
    memcpy(p.x, start, sizeof p.x);
    for (int k = 0; k < (int)(PATH_SECONDS / dt + 0.5); k++) {
        if (!point_step(&f, &p, friction, dt, 0) ||
            p.push < 0.25 * PATH_GRAVITY * dt || p.level > cos(15 * degree) ||
            p.level < cos(75 * degree))
            return false;
    }
    for (int c = 0; c < 3; c++)
        way[c] = p.x[c] - start[c];
    return apart3(start, p.x) > 0.1;
}

/* The mean way of four points that start 10 mm around; false: one of them does
 * not slide as it should. */
static bool around(const struct ground *g, const double start[3],
                   double friction, double mean[3])
{
    double n[3], side[3], way[3];
    ground_height(g, start, n);
    memset(mean, 0, 3 * sizeof *mean);
    for (int k = 0; k < 4; k++) {
        double axis[3] = {0}, x[3];
        axis[k < 2 ? 0 : 2] = k % 2 ? 1 : -1;
        cross3(n, axis, side);
        double length = sqrt(dot3(side, side));
        for (int c = 0; c < 3; c++)
            x[c] = start[c] + 0.01 * side[c] / length;
        if (!ground_put(g, x, 0) || !slides(g, x, friction, way))
            return false;
        for (int c = 0; c < 3; c++)
            mean[c] += way[c] / 4;
    }
    return true;
}

/* Whether the point's way says what a sheet's is: within 2 % it is that of a
 * point on a ground that is smoothed farther, and the mean of those around. */
static bool certain(const struct ground *g, const struct ground *coarse,
                    const double start[3], double friction)
{
    double way[3], other[3], there[3];
    memcpy(there, start, sizeof there);
    if (!slides(g, start, friction, way) || !ground_put(coarse, there, 0) ||
        !slides(coarse, there, friction, other))
        return false;
    double most = 0.02 * sqrt(dot3(way, way));
    if (!(apart3(way, other) < most))
        return false;
    return around(g, start, friction, other) && apart3(way, other) < most;
}

/* Whether gravity less friction pulls a point at rest by 0.3 to 0.6 g. */
static bool pulled(const struct ground *g, const double x[3], double friction)
{
    double n[3];
    if (isnan(ground_height(g, x, n)) || !(n[1] > 0))
        return false;
    double pull = sqrt(1 - n[1] * n[1]) - friction * n[1];
    return pull > 0.3 && pull < 0.6;
}

int find_paths(const struct ground *g, const struct ground *coarse,
               double friction, double start[PATHS][3])
{
    int found = 0;
    /* Middles of triangles, in an order that has nothing to do with them. */
    for (int64_t k = 1; k <= g->nt && found < PATHS; k++) {
        const int32_t *v = g->tri[(k * 7919) % g->nt];
        double x[3];
        for (int c = 0; c < 3; c++)
            x[c] = (g->x[v[0]][c] + g->x[v[1]][c] + g->x[v[2]][c]) / 3;
        bool good = ground_put(g, x, 0) && pulled(g, x, friction);
        for (int f = 0; f < found && good; f++)
            good = apart3(start[f], x) > 0.2;
        if (good && certain(g, coarse, x, friction))
            memcpy(start[found++], x, sizeof x);
    }
    return found;
}
