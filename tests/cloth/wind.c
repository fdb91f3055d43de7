/* SPDX-License-Identifier: Apache-2.0 */
/* Stage wind: generator and properties. spec/cloth/wind.md */
#include "ref/cloth/wind.h"

#include <stdlib.h>

#include "tests/panel/odd.h"

const struct field fields_wind[] = {IN(wind, cell, count, 1),
                                    IN(wind, x, count, 1),
                                    IN(wind, v, count, 1),
                                    IN(wind, mass, n_inertia, 1),
                                    IN(wind, corner, n_cells, 1),
                                    IN(wind, owner, n_parts, 1),
                                    IN(wind, push, n_parts, 1),
                                    SCRATCH(wind, load, n_cells, 1),
                                    SCRATCH(wind, part, count, 2),
                                    SCRATCH(wind, rate, n_inertia, 2),
                                    OUT(wind, force, count, 1),
                                    OUT(wind, inertia, n_inertia, 1),
                                    FIELD_END};

void gen_wind(struct bytes *b, struct wind *s)
{
    struct odd a = {0};
    if (for_bench(b) || pick(b, 2)) {
        a.grid = pick_grid(b);
        a.x = pick_state(b, &a.grid);
    } else {
        a = pick_odd(b);
    }
    const struct grid g = a.grid;
    s->m = g.m;
    s->n = g.n;
    s->count = g.count;
    s->cell = g.cell;
    s->n_cells = a.panel.n_cells;
    s->corner = (const int32_t(*)[4])a.panel.corner;
    s->n_parts = a.panel.n_parts;
    s->owner = a.panel.part;
    s->push = (const int32_t(*)[4])a.panel.push;
    s->x = a.x;
    s->v = pick_vecs(b, g.count, 10);
    s->air = pick_vec(b, 10);
    s->drag = pick(b, 3) ? pick_uniform(b, 0, 2) : 0;
    s->lift = pick(b, 3) ? pick_uniform(b, 0, 2) : 0;
    s->n_inertia = pick(b, 3) ? g.count : 0;
    s->mass = g.mass;
    s->tau = pick_uniform(b, 0, R(0.1));
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

/* What the triangles around a particle give it. */
struct sum {
    double force[3], error;  /* N, and a bound of the error */
    double rate, rate_error; /* kg/s, likewise */
};

/* Adds the area vector of the triangle a, b, c to n, and to size what bounds
 * its rounding. */
static void add_area(const double a[3], const double b[3], const double c[3],
                     double n[3], double *size)
{
    double ab[3], ac[3];
    for (int k = 0; k < 3; k++) {
        ab[k] = b[k] - a[k];
        ac[k] = c[k] - a[k];
    }
    for (int k = 0; k < 3; k++) {
        int i = (k + 1) % 3, j = (k + 2) % 3;
        n[k] += (ab[i] * ac[j] - ab[j] * ac[i]) / 2;
    }
    *size += sqrt(dot(ab, ab) * dot(ac, ac));
}

/* The area vector of a cell of 3 or 4 corners: that of its triangles. */
static double area_of(int corners, const double x[4][3], double n[3],
                      double *size)
{
    double zero[3] = {0}, way[2][3], other[3] = {0};
    *size = n[0] = n[1] = n[2] = 0;
    add_area(x[0], x[1], x[2], n, size);
    if (corners == 4) {
        add_area(x[0], x[2], x[3], n, size);
        for (int k = 0; k < 3; k++) {
            way[0][k] = x[2][k] - x[0][k];
            way[1][k] = x[3][k] - x[1][k];
        }
        add_area(zero, way[0], way[1], other, size);
    }
    return sqrt(dot(n, n));
}

/* §1, §3, §4 in binary64, by the angle between wind and normal: drag along the
 * wind, lift across it. Adds the share of each corner. */
static void scatter(const struct wind *s, int corners, const int64_t t[4],
                    struct sum *to)
{
    double x[4][3], v[4][3], u[3], n[3], size;
    load(s->air, u);
    double speed = sqrt(dot(u, u));
    for (int c = 0; c < corners; c++) {
        load(s->x[t[c]], x[c]);
        load(s->v[t[c]], v[c]);
        speed += sqrt(dot(v[c], v[c]));
        for (int k = 0; k < 3; k++)
            u[k] -= v[c][k] / corners;
    }
    double area = area_of(corners, (const double(*)[3])x, n, &size);
    double air = sqrt(dot(u, u));
    double both = (double)s->drag + (double)s->lift;
    double error = both * speed * (60 * REAL_U * size + 1e-21);
    double cosine = area * air > 0 ? dot(n, u) / (area * air) : 0;
    for (int c = 0; c < corners; c++) {
        struct sum *f = &to[t[c]];
        for (int k = 0; k < 3 && area * air > 0; k++) {
            double across = n[k] / area - cosine * u[k] / air;
            double along = (double)s->drag * fabs(cosine) * u[k] / air;
            f->force[k] += area * air * air / corners *
                           (along + (double)s->lift * cosine * across);
        }
        f->rate += both * area * air * fabs(cosine) / corners;
        f->error += size < 1e12 ? error * speed : 1e300;
        f->rate_error += size < 1e12 ? error : 1e300;
    }
}

static const char *judge(const struct wind *s, int64_t p, const struct sum *f)
{
    for (int k = 0; k < 3; k++) {
        double have = (double)(&s->force[p].x)[k];
        if (!(f->error >= 1e300 ||
              fabs(have - f->force[k]) <= f->error + 1e-35))
            return "wind §2: not the sum of the triangles around a particle";
    }
    if (!s->n_inertia)
        return NULL;
    double want = (double)s->mass[p] + (double)s->tau * f->rate;
    double error = (double)s->tau * f->rate_error + 4 * REAL_U * want + 1e-35;
    if (!(f->rate_error >= 1e300 ||
          fabs((double)s->inertia[p] - want) <= error))
        return "wind §3: not the mass and what the air adds to it";
    return s->inertia[p] >= s->mass[p] ? NULL
                                       : "wind §3: less inertia than mass";
}

const char *prop_wind(const struct wind *s)
{
    const char *bad = NULL;
    struct sum *f = calloc((size_t)s->count + 1, sizeof *f);
    for (int64_t p = 0; p < s->count; p++) {
        int64_t lower[4] = {p, p + 1, p + s->m + 1};
        int64_t upper[4] = {p, p + s->m + 1, p + s->m};
        if (!s->cell[p])
            continue;
        scatter(s, 3, lower, f);
        scatter(s, 3, upper, f);
    }
    for (int64_t k = 0; k < s->n_cells; k++) {
        const int32_t *at = s->corner[k];
        int64_t t[4] = {at[0], at[1], at[2], at[3]};
        scatter(s, at[3] == at[0] ? 3 : 4, t, f);
    }
    for (int64_t p = 0; p < s->count && !bad; p++)
        bad = judge(s, p, &f[p]);
    free(f);
    return bad;
}
