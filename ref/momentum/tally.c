/* SPDX-License-Identifier: Apache-2.0 */
/* Mass, momentum and inertia of bodies and of islands of them, on the host.
 * spec/momentum/momentum.md §3 */
#include "ref/momentum/tally.h"

#include <math.h>

/* §3.3: the least determinant of an inertia that is divided by its trace. */
static const double DEGENERATE = 0x1p-16;
/* §3.4: a slice that gains more than such a part of its energy is one that
 * step.md §7.3 has to see. */
static const double JUMP = 16;

static void cross_product(const double a[3], const double b[3], double r[3])
{
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        r[i] = a[j] * b[k] - a[k] * b[j];
    }
}

static double dot_product(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* The place of row i and column j of a symmetric matrix. */
static int index_of(int i, int j)
{
    static const int place[3][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}};
    return place[i][j];
}

/* §3.1: adds what a part of mass m and momentum p has about the centre of t,
 * from which its own centre lies by d. */
static void add_apart(struct tally *t, double m, const double p[3],
                      const double d[3])
{
    double l[3];
    cross_product(d, p, l);
    for (int i = 0; i < 3; i++) {
        t->l[i] += l[i];
        for (int j = i; j < 3; j++)
            t->spread[index_of(i, j)] += m * d[i] * d[j];
    }
}

struct tally tally_of(const struct moments *s)
{
    const real *a = s->value, *place = &s->at.x, *speed = &s->speed.x;
    struct tally t = {.mass = (double)a[MOMENT_MASS]};
    double d[3], back[3];
    for (int i = 0; i < 3; i++) {
        double p = (double)a[MOMENT_SPEED + i];
        d[i] = (double)a[MOMENT_PLACE + i] / t.mass;
        back[i] = -p;
        t.centre[i] = (double)place[i] + d[i];
        t.p[i] = t.mass * (double)speed[i] + p;
        t.l[i] = (double)a[MOMENT_SPIN + i];
    }
    t.kinetic =
        ((double)a[MOMENT_SQUARE] - dot_product(back, back) / t.mass) / 2;
    for (int k = 0; k < 6; k++)
        t.spread[k] = (double)a[MOMENT_SPREAD + k];
    add_apart(&t, -t.mass, back, d);
    return t;
}

void tally_join(int n, const int32_t *of, const struct tally *part,
                struct tally *island)
{
    memset(island, 0, (size_t)n * sizeof *island);
    for (int k = 0; k < n; k++) {
        struct tally *t = &island[of[k]];
        double m = t->mass + part[k].mass;
        for (int i = 0; i < 3; i++) {
            double d = part[k].centre[i] - t->centre[i];
            t->centre[i] += part[k].mass / m * d;
            t->p[i] += part[k].p[i];
        }
        t->elastic += part[k].elastic;
        t->mass = m;
    }
    for (int k = 0; k < n; k++) {
        struct tally *t = &island[of[k]];
        double d[3], u[3];
        for (int i = 0; i < 3; i++) {
            d[i] = part[k].centre[i] - t->centre[i];
            u[i] = part[k].p[i] / part[k].mass - t->p[i] / t->mass;
            t->l[i] += part[k].l[i];
        }
        t->kinetic += part[k].kinetic + part[k].mass * dot_product(u, u) / 2;
        for (int i = 0; i < 6; i++)
            t->spread[i] += part[k].spread[i];
        add_apart(t, part[k].mass, part[k].p, d);
    }
}

/* §3.3: the angular velocity with which t has the angular momentum l. False: t
 * is close to a line. */
static bool find_turn(const struct tally *t, const double l[3], double dw[3])
{
    double trace = t->spread[0] + t->spread[3] + t->spread[5];
    double a[3][3], b[3][3];
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            a[i][j] =
                ((i == j ? trace : 0) - t->spread[index_of(i, j)]) / trace;
    for (int i = 0; i < 3; i++) /* row i of the adjugate, which is symmetric */
        cross_product(a[(i + 1) % 3], a[(i + 2) % 3], b[i]);
    double det = dot_product(a[0], b[0]);
    for (int i = 0; i < 3; i++)
        dw[i] = dot_product(b[i], l) / (det * trace);
    return det > DEGENERATE;
}

/* An angular velocity, 1/s, and its energy, J. */
struct turning {
    double w[3], energy;
};

/* §3.3: the angular velocity with which t has the angular momentum l; none if t
 * is close to a line. */
static struct turning turning_of(const struct tally *t, const double l[3])
{
    struct turning r = {{0, 0, 0}, 0};
    if (find_turn(t, l, r.w))
        r.energy = dot_product(l, r.w) / 2;
    else
        memset(r.w, 0, sizeof r.w);
    return r;
}

/* §3.4: the factor of velocities by which an energy of `all` loses `over`. */
static double factor_of(double all, double over)
{
    return over > 0 ? sqrt(fmax(0, all - over) / all) : 1;
}

struct gain tally_gain(const struct tally *before, const struct tally *after,
                       const double p[3])
{
    struct turning is = turning_of(after, after->l);
    struct turning ought = turning_of(after, before->l);
    double lost =
        before->kinetic + before->elastic - after->kinetic - after->elastic;
    double own = after->kinetic + after->elastic;
    double more = ought.energy - is.energy - fmax(0, lost);
    double rest = fmax(0, after->kinetic - is.energy);
    double part = factor_of(ought.energy, more - rest);
    if (lost < 0 && -lost <= own / JUMP)
        more -= lost;
    struct gain g = {.keep = rest > 0 ? factor_of(rest, more) : 1};
    memcpy(g.centre, after->centre, sizeof g.centre);
    for (int i = 0; i < 3; i++) {
        g.dv[i] = (p[i] - g.keep * after->p[i]) / after->mass;
        g.dw[i] = part * ought.w[i] - g.keep * is.w[i];
    }
    return g;
}
