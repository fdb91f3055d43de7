/* SPDX-License-Identifier: Apache-2.0 */
/* Stage wind: generator and properties. spec/cloth/wind.md */
#include "ref/cloth/wind.h"

#include <stdlib.h>

#include "tests/cloth/sheet.h"

const struct field fields_wind[] = {
    IN(wind, cell, count, 1),   IN(wind, x, count, 1),
    IN(wind, v, count, 1),      SCRATCH(wind, part, count, 2),
    OUT(wind, force, count, 1), FIELD_END};

void gen_wind(struct bytes *b, struct wind *s)
{
    struct grid g = pick_grid(b);
    s->m = g.m;
    s->n = g.n;
    s->count = g.count;
    s->cell = g.cell;
    s->x = pick_state(b, &g);
    s->v = pick_vecs(b, g.count, 10);
    s->air = pick_vec(b, 10);
    s->drag = pick(b, 3) ? pick_uniform(b, 0, 2) : 0;
    s->lift = pick(b, 3) ? pick_uniform(b, 0, 2) : 0;
}

static void load(vec a, double x[3])
{
    x[0] = (double)a.x;
    x[1] = (double)a.y;
    x[2] = (double)a.z;
}

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* §1 in binary64, by the angle between wind and normal: drag along the wind,
 * lift across it. Adds a third of the force to f[4·p … 4·p + 2] of each corner
 * p, and a bound on the error to f[4·p + 3]. */
static void scatter(const struct wind *s, const int64_t t[3], double *f)
{
    double x[3][3], v[3][3], ab[3], ac[3], u[3], n[3], speed = 0;
    load(s->air, u);
    speed = sqrt(dot(u, u));
    for (int c = 0; c < 3; c++) {
        load(s->x[t[c]], x[c]);
        load(s->v[t[c]], v[c]);
        speed += sqrt(dot(v[c], v[c]));
        for (int k = 0; k < 3; k++)
            u[k] -= v[c][k] / 3;
    }
    for (int k = 0; k < 3; k++) {
        ab[k] = x[1][k] - x[0][k];
        ac[k] = x[2][k] - x[0][k];
    }
    for (int k = 0; k < 3; k++) {
        int i = (k + 1) % 3, j = (k + 2) % 3;
        n[k] = (ab[i] * ac[j] - ab[j] * ac[i]) / 2;
    }
    double area = sqrt(dot(n, n)), air = sqrt(dot(u, u));
    double size = sqrt(dot(ab, ab) * dot(ac, ac));
    double both = (double)s->drag + (double)s->lift;
    double error = both * speed * speed * (60 * REAL_U * size + 1e-21);
    double cosine = area * air > 0 ? dot(n, u) / (area * air) : 0;
    for (int c = 0; c < 3; c++) {
        for (int k = 0; k < 3 && area * air > 0; k++) {
            double across = n[k] / area - cosine * u[k] / air;
            double along = (double)s->drag * fabs(cosine) * u[k] / air;
            f[4 * t[c] + k] += area * air * air / 3 *
                               (along + (double)s->lift * cosine * across);
        }
        f[4 * t[c] + 3] += size < 1e12 ? error : 1e300;
    }
}

const char *prop_wind(const struct wind *s)
{
    const char *bad = NULL;
    double *f = calloc((size_t)s->count * 4 + 1, sizeof *f);
    for (int64_t p = 0; p < s->count; p++) {
        int64_t lower[3] = {p, p + 1, p + s->m + 1};
        int64_t upper[3] = {p, p + s->m + 1, p + s->m};
        if (!s->cell[p])
            continue;
        scatter(s, lower, f);
        scatter(s, upper, f);
    }
    for (int64_t k = 0; k < 3 * s->count && !bad; k++) {
        double have = (double)(&s->force[k / 3].x)[k % 3];
        const double *want = f + 4 * (k / 3);
        if (!(want[3] >= 1e300 || fabs(have - want[k % 3]) <= want[3] + 1e-35))
            bad = "wind §2: not the sum of the triangles around a particle";
    }
    free(f);
    return bad;
}
