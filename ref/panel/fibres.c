/* SPDX-License-Identifier: Apache-2.0 */
/* The forms of the fibres of an odd cell, from its corners at rest.
 * spec/panel/panel.md §2 */
#include "ref/panel/fibres.h"

static double triangle_area(const double a[2], const double b[2],
                            const double c[2])
{
    return 0.5 *
           ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]));
}

double cell_area(const double x[4][2], int corners)
{
    double area = triangle_area(x[0], x[1], x[2]);
    return corners == 4 ? area + triangle_area(x[0], x[2], x[3]) : area;
}

/* §2: hu and hv times the mean gradient of corner k. */
static void mean_gradient(const double x[4][2], int corners, int k, double hu,
                          double hv, double g[2])
{
    const double *after = x[(k + 1) % corners];
    const double *before = x[(k + corners - 1) % corners];
    double area = cell_area(x, corners);
    g[0] = 0.5 * hu * (after[1] - before[1]) / area;
    g[1] = -0.5 * hv * (after[0] - before[0]) / area;
}

/* §2: half of η of corner k of a quadrilateral. */
static double null_form(const double x[4][2], int k)
{
    const double *a = x[(k + 1) % 4], *b = x[(k + 2) % 4], *c = x[(k + 3) % 4];
    double part = triangle_area(a, b, c) / cell_area(x, 4);
    return k % 2 ? -part : part;
}

void make_fibres(const double x[4][2], int corners, double hu, double hv,
                 struct fibre fibre[FIBRES])
{
    double area = cell_area(x, corners) / (hu * hv);
    memset(fibre, 0, FIBRES * sizeof *fibre);
    for (int f = 0; f < FIBRES; f++) {
        bool half = fibre_law[f] < 2; /* u and v have two fibres each */
        if (corners == 4 || !half || f % 2 == 0)
            fibre[f].weight = (real)(half && corners == 4 ? 0.5 * area : area);
    }
    for (int k = 1; k < corners; k++) {
        double g[2], n = corners == 4 ? null_form(x, k) : 0;
        mean_gradient(x, corners, k, hu, hv, g);
        const double c[FIBRES] = {g[0] - n, g[0] + n,    g[1] - n,
                                  g[1] + n, g[0] + g[1], g[1] - g[0]};
        for (int f = 0; f < FIBRES; f++)
            fibre[f].c[k - 1] = fibre[f].weight > 0 ? (real)c[f] : 0;
    }
}
