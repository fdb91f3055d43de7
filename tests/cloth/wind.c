/* SPDX-License-Identifier: Apache-2.0 */
/* Stage wind: generator and properties. spec/cloth/wind.md */
#include "ref/cloth/wind.h"

#include <stdlib.h>

#include "tests/cloth/sheet.h"

const struct field fields_wind[] = {IN(wind, cell, count, 1),
                                    IN(wind, x, count, 1),
                                    IN(wind, v, count, 1),
                                    IN(wind, mass, n_inertia, 1),
                                    SCRATCH(wind, part, count, 2),
                                    SCRATCH(wind, rate, n_inertia, 2),
                                    OUT(wind, force, count, 1),
                                    OUT(wind, inertia, n_inertia, 1),
                                    FIELD_END};

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

static double area_of(const double x[3][3], double n[3], double *size)
{
    double ab[3], ac[3];
    for (int k = 0; k < 3; k++) {
        ab[k] = x[1][k] - x[0][k];
        ac[k] = x[2][k] - x[0][k];
    }
    for (int k = 0; k < 3; k++) {
        int i = (k + 1) % 3, j = (k + 2) % 3;
        n[k] = (ab[i] * ac[j] - ab[j] * ac[i]) / 2;
    }
    *size = sqrt(dot(ab, ab) * dot(ac, ac));
    return sqrt(dot(n, n));
}

/* §1, §3 in binary64, by the angle between wind and normal: drag along the
 * wind, lift across it. Adds a third of each to the corners. */
static void scatter(const struct wind *s, const int64_t t[3], struct sum *to)
{
    double x[3][3], v[3][3], u[3], n[3], size;
    load(s->air, u);
    double speed = sqrt(dot(u, u));
    for (int c = 0; c < 3; c++) {
        load(s->x[t[c]], x[c]);
        load(s->v[t[c]], v[c]);
        speed += sqrt(dot(v[c], v[c]));
        for (int k = 0; k < 3; k++)
            u[k] -= v[c][k] / 3;
    }
    double area = area_of((const double(*)[3])x, n, &size);
    double air = sqrt(dot(u, u));
    double both = (double)s->drag + (double)s->lift;
    double error = both * speed * (60 * REAL_U * size + 1e-21);
    double cosine = area * air > 0 ? dot(n, u) / (area * air) : 0;
    for (int c = 0; c < 3; c++) {
        struct sum *f = &to[t[c]];
        for (int k = 0; k < 3 && area * air > 0; k++) {
            double across = n[k] / area - cosine * u[k] / air;
            double along = (double)s->drag * fabs(cosine) * u[k] / air;
            f->force[k] += area * air * air / 3 *
                           (along + (double)s->lift * cosine * across);
        }
        f->rate += both * area * air * fabs(cosine) / 3;
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
        int64_t lower[3] = {p, p + 1, p + s->m + 1};
        int64_t upper[3] = {p, p + s->m + 1, p + s->m};
        if (!s->cell[p])
            continue;
        scatter(s, lower, f);
        scatter(s, upper, f);
    }
    for (int64_t p = 0; p < s->count && !bad; p++)
        bad = judge(s, p, &f[p]);
    free(f);
    return bad;
}
