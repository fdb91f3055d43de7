/* SPDX-License-Identifier: Apache-2.0 */
/* The height of a point over the facets of a mesh. spec/validation.md §9 */
#include "validate/path.h"

#include <math.h>
#include <string.h>

/* m: what is farther is another part of the statue. */
static const double FAR = 0.02;

/* The corners of a triangle, and its area along its normal. */
static void corners_of(const drape_obstacle *o, int64_t t, double at[3][3],
                       double area[3])
{
    double a[3], b[3];
    for (int k = 0; k < 3; k++)
        memcpy(at[k], o->x[o->tri[t][k]], sizeof at[k]);
    for (int c = 0; c < 3; c++) {
        a[c] = (at[1][c] - at[0][c]) / 2;
        b[c] = at[2][c] - at[0][c];
    }
    cross3(a, b, area);
}

/* The place on the edge from a to b that is nearest to x. */
static void on_edge(const double x[3], const double a[3], const double b[3],
                    double out[3])
{
    double d[3], to[3];
    for (int c = 0; c < 3; c++) {
        d[c] = b[c] - a[c];
        to[c] = x[c] - a[c];
    }
    double part = fmin(1, fmax(0, dot3(to, d) / dot3(d, d)));
    for (int c = 0; c < 3; c++)
        out[c] = a[c] + part * d[c];
}

/* The place on a triangle that is nearest to x: below x, or on an edge that has
 * x on its outer side. */
static void on_facet(const double x[3], const double at[3][3],
                     const double area[3], double out[3])
{
    double best = INFINITY, to[3], side[3], outward[3], place[3];
    for (int c = 0; c < 3; c++)
        to[c] = x[c] - at[0][c];
    double high = dot3(to, area) / dot3(area, area);
    for (int c = 0; c < 3; c++)
        out[c] = x[c] - high * area[c];
    for (int k = 0; k < 3; k++) {
        const double *a = at[k], *b = at[(k + 1) % 3];
        for (int c = 0; c < 3; c++) {
            side[c] = b[c] - a[c];
            to[c] = x[c] - a[c];
        }
        cross3(side, area, outward);
        if (!(dot3(to, outward) > 0))
            continue;
        on_edge(x, a, b, place);
        if (apart3(x, place) < best) {
            best = apart3(x, place);
            memcpy(out, place, sizeof place);
        }
    }
}

/* Negative behind the nearest facet, whose normal is then the normal. */
static double facet_height(const void *ground, const double x[3],
                           double normal[3])
{
    const drape_obstacle *o = ground;
    double nearest = FAR, at[3][3], area[3], place[3];
    bool behind = false;
    for (int64_t t = 0; t < o->n_triangles; t++) {
        corners_of(o, t, at, area);
        double size = fmax(apart3(at[0], at[1]), apart3(at[0], at[2]));
        if (apart3(x, at[0]) > nearest + size)
            continue;
        on_facet(x, (const double(*)[3])at, area, place);
        double distance = apart3(x, place), high = 0;
        if (!(distance < nearest))
            continue;
        nearest = distance;
        for (int c = 0; c < 3; c++)
            high += (x[c] - place[c]) * area[c];
        behind = !(high > 0);
        for (int c = 0; c < 3; c++)
            normal[c] = behind ? area[c] / sqrt(dot3(area, area))
                               : (x[c] - place[c]) / distance;
    }
    return nearest < FAR ? (behind ? -nearest : nearest) : NAN;
}

struct floor floor_facets(const drape_obstacle *obstacle)
{
    return (struct floor){facet_height, obstacle, true};
}
