/* SPDX-License-Identifier: Apache-2.0 */
/* Checks friction, momentum and energy in contact, and measures how a drape
 * changes with dt and grid. spec/accuracy.md §5 */
#include "bench/accuracy.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

struct slope {
    double tangent, friction, tolerance, dt;
    int integrator, steps;
};

/* Returns the mean distance, m, that a sheet at rest slides down a slope. */
static double slide(struct bench *b, const struct slope *s, struct run *r)
{
    double slope = atan(s->tangent);
    drape_def def;
    drape_cloth c;
    struct solid plane;
    drape_default(&def);
    cloth_flat(&c, 9, 0.2, 0);
    solid_plane(&plane, 8, slope);
    /* The plane is one triangle: the edge between two would push sideways. */
    static const double wide[3][2] = {{-9, -9}, {27, -9}, {-9, 27}};
    for (int k = 0; k < 3; k++) {
        plane.x[k][0] = wide[k][0] * cos(slope);
        plane.x[k][1] = -wide[k][0] * sin(slope);
        plane.x[k][2] = wide[k][1];
    }
    plane.body.n_vertices = 3;
    plane.body.n_triangles = 1;
    double out[3] = {sin(slope), cos(slope), 0};
    c.u[0] = cos(slope);
    c.u[1] = -sin(slope);
    for (int k = 0; k < 3; k++) /* just closer than the thickness */
        c.origin[k] = -0.1 * c.u[k] - 0.1 * c.v[k] + 0.0019 * out[k];
    c.material.friction = plane.body.friction = s->friction;
    def.tolerance = s->tolerance;
    def.dt = s->dt;
    def.cloths = &c;
    def.n_cloths = 1;
    def.obstacles = &plane.body;
    def.n_obstacles = 1;
    def.integrator = s->integrator;
    def.sleep = 0;
    run_scene(b, &def, s->steps, r);
    double way = 0;
    for (int p = 0; p < 81 && r->x; p++)
        for (int k = 0; k < 3; k++)
            way += (r->x[p][k] - c.origin[k]) * c.u[k] / 81;
    solid_free(&plane);
    return way - 0.1; /* the middle starts 0.1 m from particle 0 */
}

/* The way of n steps from rest under a constant acceleration a, in units of
 * a dt²: the integrator's own. spec/cloth/implicit.md §5 */
static double steps_way(int integrator, double n)
{
    if (integrator == DRAPE_BW)
        return n * (n + 1) / 2;
    return n * n / 2 + 0.75 * (1 - pow(3, -n));
}

/* Compares with Coulomb's law: the sheet rests below the cone's slope, and
 * accelerates with g (sin - μ cos) above it, by the integrator's steps. */
static void slide_row(struct bench *b, FILE *out, const struct slope *s)
{
    struct run r;
    double way = slide(b, s, &r), angle = atan(s->tangent), n = s->steps;
    double a = fmax(0, 9.81 * (sin(angle) - s->friction * cos(angle)));
    double due = a * s->dt * s->dt * steps_way(s->integrator, n);
    fprintf(out, "%g,%g,%s,%.4g,%g,%.6g,%.6g,%.3g,%.1f,%s\n", s->tangent,
            s->friction, integrator_name[s->integrator], s->dt, s->tolerance,
            way, due, way - due, (double)r.iterations / n, run_word(&r));
    /* The error allowed by spec/accuracy.md §5: twice the tolerance of the
     * solve, of the distances that gravity and friction alone would give, since
     * the distance may be a small difference of the two; and 1/2 mm/s. */
    double t = n * s->dt, pull = 9.81 * sin(angle) * t * t / 2;
    double rub = 9.81 * s->friction * cos(angle) * t * t / 2;
    double creep = s->friction > 0 ? 5e-4 * t : 0;
    bench_check(b, fabs(way - due) <= 2 * s->tolerance * (pull + rub) + creep,
                "slope %g, friction %g, %s: %g m, Coulomb %g m", s->tangent,
                s->friction, integrator_name[s->integrator], way, due);
    run_free(&r);
}

static void friction(struct bench *b)
{
    FILE *out =
        bench_csv(b, "friction",
                  "slope,friction,integrator,dt,tolerance,way m,Coulomb m,"
                  "difference m,iterations a step,end");
    static const double tangent[] = {0.25, 0.5, 0.75};
    static const double mu[] = {0, 0.2, 0.45, 0.55, 0.8};
    for (int k = 0; k < 2 * 3 * 5 * 2; k++) {
        int part = k % 2 ? 16 : 1; /* steps in 1/60 s */
        struct slope s = {.tangent = tangent[k / 2 % 3],
                          .friction = mu[k / 6 % 5],
                          .tolerance = 1e-3,
                          .dt = 1.0 / 60 / part,
                          .integrator = DRAPE_BW + k / 30,
                          .steps = (b->quick ? 15 : 60) * part};
        if (!b->quick || (part == 1 && k / 6 % 5 % 3 < 2))
            slide_row(b, out, &s);
    }
    fclose(out);
}

struct sums {
    double momentum[3], mass, energy, rise, lost;
    int64_t steps, pairs;
    double weight[2][17 * 17];
};

/* Sets the mass of each particle of sheet k. A border particle has half the
 * mass of an inner one, and a corner a quarter. */
static void weigh(struct sums *s, int k, int side, double mass)
{
    for (int p = 0; p < side * side; p++) {
        int i = p % side, j = p / side;
        double w = mass / ((side - 1) * (side - 1));
        w *= i == 0 || i == side - 1 ? 0.5 : 1;
        s->weight[k][p] = w * (j == 0 || j == side - 1 ? 0.5 : 1);
    }
}

static void momentum(const struct sums *s, int n, double (*v)[3], double out[3])
{
    memset(out, 0, 3 * sizeof *out);
    for (int p = 0; p < 2 * n; p++)
        for (int k = 0; k < 3; k++)
            out[k] += s->weight[p / n][p % n] * v[p][k];
}

static bool add(void *user, drape_world *world, const drape_step_report *report)
{
    struct sums *s = user;
    double energy = report->kinetic + report->elastic;
    if (s->steps++)
        s->rise = fmax(s->rise, energy - s->energy);
    s->energy = energy;
    s->pairs += world_pairs(world, 2);
    return true;
}

struct clash {
    int integrator;
    double ratio, dt, tolerance;
};

/* Two sheets collide in empty space. Energy that the response creates shows as
 * a rise, since nothing else adds energy. */
static void collide(struct bench *b, FILE *out, const struct clash *q)
{
    int integrator = q->integrator;
    double ratio = q->ratio, tolerance = q->tolerance;
    enum { SIDE = 17, N = SIDE * SIDE };
    static double v[2][N][3];
    static struct sums s;
    drape_def def;
    drape_cloth c[2];
    struct run r;
    s = (struct sums){0};
    drape_default(&def);
    double before[3], after[3], speed = 1;
    for (int k = 0; k < 2; k++) {
        cloth_flat(&c[k], SIDE, 0.4, 0.02 * k);
        c[k].origin[0] += 0.13 * k;
        c[k].material.density = k ? 0.2 * ratio : 0.2;
        for (int p = 0; p < N; p++)
            v[k][p][1] = k ? -speed / ratio : speed;
        c[k].velocity = (const double(*)[3])v[k];
        weigh(&s, k, SIDE, c[k].material.density * 0.16);
    }
    momentum(&s, N, v[0], before);
    memset(def.gravity, 0, sizeof def.gravity);
    def.cloths = c;
    def.n_cloths = 2;
    def.integrator = integrator;
    def.tolerance = tolerance;
    def.sleep = 0;
    def.dt = q->dt;
    run_watched(b, &def, (int)(0.1 / def.dt + 0.5), add, &s, &r);
    momentum(&s, N, r.v, after);
    double lost = 0, scale = 0.2 * 0.16 * speed;
    for (int k = 0; k < 3; k++)
        lost = fmax(lost, fabs(after[k] - before[k]) / scale);
    double start = 0.5 * 0.2 * 0.16 * speed * speed * (1 + 1 / ratio);
    fprintf(out, "%s,%g,%.4g,%g,%.3g,%.3g,%.3g,%lld,%lld,%lld,%s\n",
            integrator_name[integrator], ratio, q->dt, tolerance, lost,
            s.rise / start, s.energy / start, (long long)r.contacts,
            (long long)r.impacts, (long long)s.pairs, run_word(&r));
    bench_check(b, s.pairs == 0, "two sheets, %s: %lld pairs intersect",
                integrator_name[integrator], (long long)s.pairs);
    bench_check(b, s.energy <= start * (1 + 1e-4),
                "two sheets, %s, ratio %g: energy %g of 1 at the end",
                integrator_name[integrator], ratio, s.energy / start);
    /* Longer steps strain the sheets, so their rise is only written down. */
    bool implicit = integrator >= DRAPE_BW;
    bool fine = q->dt < (implicit ? 5e-3 : 1.1e-3);
    bench_check(b, !fine || s.rise <= (implicit ? 1e-5 : 2e-3) * start,
                "two sheets, %s, ratio %g, dt %g: energy rises by %g",
                integrator_name[integrator], ratio, q->dt, s.rise / start);
    bench_check(b, (!fine && !implicit) || lost <= 1e-5,
                "two sheets, %s, ratio %g, dt %g: %g of p is lost",
                integrator_name[integrator], ratio, q->dt, lost);
    run_free(&r);
}

struct drape {
    double lowest, mean, elastic, contacts;
};

static struct drape drape_at(struct bench *b, int side, double dt, double time,
                             struct run *r)
{
    const double at[3] = {0, 0.3, 0};
    drape_def def;
    drape_cloth c;
    struct solid s;
    drape_default(&def);
    cloth_flat(&c, side, 0.8, 0.53);
    c.material.thickness = 0.004;
    c.material.bend = 1e-3;
    solid_ball(&s, 0.2, at, 48);
    def.cloths = &c;
    def.n_cloths = 1;
    def.obstacles = &s.body;
    def.n_obstacles = 1;
    def.dt = dt;
    run_scene(b, &def, (int64_t)(time / dt + 0.5), r);
    struct drape d = {.lowest = 1, .elastic = r->own};
    for (int p = 0; p < side * side; p++) {
        d.lowest = fmin(d.lowest, r->x[p][1]);
        d.mean += r->x[p][1] / (side * side);
    }
    solid_free(&s);
    return d;
}

static void refine(struct bench *b)
{
    FILE *out = bench_csv(b, "refine",
                          "side,dt,mean height m,lowest m,own energy J,"
                          "rms m to the last dt,seconds,end");
    const double time = 1;
    for (int side = 17; side <= 65; side = 2 * side - 1) {
        struct run last = {0};
        for (int k = 1; k <= (side == 65 ? 2 : 4); k *= 2) {
            struct run r;
            struct drape d = drape_at(b, side, 1.0 / 60 / k, time, &r);
            fprintf(out, "%d,%.5g,%.5f,%.5f,%.4g,%.3g,%.3g,%s\n", side,
                    1.0 / 60 / k, d.mean, d.lowest, d.elastic,
                    k > 1 ? run_distance(&r, &last, side * side) : 0, r.seconds,
                    run_word(&r));
            fflush(out);
            run_free(&last);
            last = r;
        }
        run_free(&last);
    }
    fclose(out);
}

void part_contact(struct bench *b)
{
    friction(b);
    FILE *out = bench_csv(
        b, "collide",
        "integrator,mass ratio,dt,tolerance,momentum lost,largest rise of "
        "energy,energy at the end,contacts,impacts,"
        "intersecting pairs,end");
    for (int m = b->quick ? DRAPE_RK4 : 0; m <= DRAPE_CK; m++)
        for (int k = 0; k <= (b->quick ? 2 : 4); k += 2)
            for (int j = b->quick ? 4 : 1; j <= (b->quick ? 4 : 16); j *= 4)
                for (int t = 3; t <= (b->quick ? 3 : 6); t += 3)
                    if (m >= DRAPE_BW || b->quick || (j == 16 && t == 3))
                        collide(b, out,
                                &(struct clash){m, pow(10, k), 1.0 / 60 / j,
                                                pow(10, -t)});
    fclose(out);
    if (!b->quick)
        refine(b);
}
