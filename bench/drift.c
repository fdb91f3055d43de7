/* SPDX-License-Identifier: Apache-2.0 */
/* Measures the drift of energy in long runs, the effect of one unit in the last
 * place at the start, and scenes far from the origin. spec/accuracy.md §6 */
#include "bench/accuracy.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

struct log {
    FILE *out;
    const struct sample *s;
    double first, most; /* J, energy after the first step; the largest
                           relative change since */
    int64_t each;
};

static bool note(void *user, drape_world *world, const drape_step_report *r)
{
    struct log *l = user;
    double energy = r->kinetic + r->elastic + r->potential;
    (void)world;
    if (r->step == 1)
        l->first = energy;
    l->most = fmax(l->most, fabs(energy / l->first - 1));
    if (r->step == 1 || r->step % l->each == 0)
        fprintf(l->out, "%s,%d,%.4g,%lld,%.6g\n",
                integrator_name[l->s->def.integrator], l->s->def.precision,
                l->s->def.dt, (long long)r->step, energy / l->first);
    return true;
}

/* Runs an undamped drum and records its energy. Symplectic methods must keep
 * it; dissipative methods may lose but not gain it. */
static void long_runs(struct bench *b)
{
    FILE *out = bench_csv(b, "drift",
                          "integrator,precision,dt,step,energy by the first");
    static const int method[] = {DRAPE_EULER, DRAPE_VERLET, DRAPE_RK4, DRAPE_BW,
                                 DRAPE_CK};
    int steps = b->quick ? 2000 : 100000;
    for (int k = 0; k < 5; k++)
        for (int precision = 32; precision <= 64; precision += 32) {
            struct sample s;
            struct run r;
            sample_make(&s, SAMPLE_STRETCHED, 6);
            s.cloth.material.damping = 0;
            s.def.integrator = method[k];
            s.def.precision = precision;
            s.def.dt = 5e-4; /* a third of Verlet's limit */
            struct log l = {out, &s, 0, 0, steps / 100};
            run_watched(b, &s.def, steps, note, &l, &r);
            double end = r.energy / l.first - 1;
            bench_check(b, r.steps == steps && !r.outcome,
                        "%s, %d bits: %lld of %d steps, %s",
                        integrator_name[method[k]], precision,
                        (long long)r.steps, steps, run_word(&r));
            bench_check(b, k < 2 ? l.most < 0.05 : end < 1e-3,
                        "%s, %d bits: energy off by %g, at the end %g",
                        integrator_name[method[k]], precision, l.most, end);
            run_free(&r);
            sample_free(&s);
        }
    fclose(out);
}

struct fall {
    drape_def def;
    drape_cloth cloth;
    struct solid ball;
    double (*x)[3];
};

static void fall_make(struct fall *f, int side, double offset)
{
    const double at[3] = {offset, 0.3, 0};
    drape_default(&f->def);
    cloth_flat(&f->cloth, side, 0.8, 0.53);
    f->cloth.material.thickness = 0.004;
    f->x = bench_take((size_t)side * (size_t)side, sizeof *f->x);
    for (int p = 0; p < side * side; p++) {
        f->x[p][0] = offset - 0.4 + 0.8 * (p % side) / (side - 1);
        f->x[p][1] = 0.53;
        f->x[p][2] = -0.4 + 0.8 * (p / side) / (side - 1);
    }
    f->cloth.x = (const double(*)[3])f->x;
    solid_ball(&f->ball, 0.2, at, 32);
    f->def.cloths = &f->cloth;
    f->def.n_cloths = 1;
    f->def.obstacles = &f->ball.body;
    f->def.n_obstacles = 1;
}

static void fall_free(struct fall *f)
{
    solid_free(&f->ball);
    free(f->x);
}

struct record {
    int side, steps;
    double (*x)[3];   /* [steps·side²] m, after each step */
    double (*sum)[3]; /* [steps] kinetic and elastic energy, J; mean height,
                         lowest point, m */
};

static bool keep(void *user, drape_world *world, const drape_step_report *r)
{
    struct record *k = user;
    size_t n = (size_t)(k->side * k->side), at = (size_t)r->step - 1;
    double(*x)[3] = bench_take((size_t)drape_vertices(world), sizeof *x);
    drape_read(world, x, NULL);
    memcpy(k->x + at * n, x, n * sizeof *x);
    k->sum[at][0] = r->kinetic + r->elastic;
    k->sum[at][2] = x[0][1];
    for (size_t p = 0; p < n; p++) {
        k->sum[at][1] += x[p][1] / (double)n;
        k->sum[at][2] = fmin(k->sum[at][2], x[p][1]);
    }
    free(x);
    return true;
}

static void compare(FILE *out, const char *scene, const struct record *k)
{
    int n = k->side * k->side;
    for (int t = 0; t < k->steps; t++) {
        double sum = 0, most = 0;
        for (int p = 0; p < n; p++)
            for (int i = 0; i < 3; i++) {
                double d = k[0].x[t * n + p][i] - k[1].x[t * n + p][i];
                sum += d * d;
                most = fmax(most, fabs(d));
            }
        fprintf(out, "%s,%d,%.3e,%.3e", scene, t + 1, sqrt(sum / n), most);
        for (int i = 0; i < 3; i++)
            fprintf(out, ",%.6g,%.3e", k[0].sum[t][i],
                    fabs(k[0].sum[t][i] - k[1].sum[t][i]));
        fprintf(out, "\n");
    }
}

/* Compares two runs, of which the second starts with one coordinate higher by
 * one unit in the last place of binary32. The sheet falls on a ball, or hangs
 * by two corners. */
static void one_unit(struct bench *b, FILE *out, bool ball)
{
    int side = b->quick ? 9 : 33, steps = b->quick ? 10 : 180;
    struct record k[2];
    for (int i = 0; i < 2; i++) {
        struct fall f;
        struct run r;
        drape_pin pin[2] = {{0, 0, -1}, {side - 1, 0, -1}};
        fall_make(&f, side, 0);
        int middle = side * side / 2;
        if (i)
            f.x[middle][1] = nextafterf((float)f.x[middle][1], 1);
        if (!ball) {
            f.def.n_obstacles = 0;
            f.cloth.pins = pin;
            f.cloth.n_pins = 2;
        }
        k[i] = (struct record){side, steps, NULL, NULL};
        k[i].x = bench_take((size_t)(steps * side * side), sizeof *k[i].x);
        k[i].sum = bench_take((size_t)steps, sizeof *k[i].sum);
        run_watched(b, &f.def, steps, keep, &k[i], &r);
        run_free(&r);
        fall_free(&f);
    }
    compare(out, ball ? "ball" : "two corners", k);
    for (int i = 0; i < 2; i++) {
        free(k[i].x);
        free(k[i].sum);
    }
}

static void offsets(struct bench *b)
{
    FILE *out = bench_csv(b, "offset",
                          "offset m,precision,rms m to the origin's,contacts,"
                          "impacts,end,text");
    struct run origin = {0};
    int side = 17, steps = 30;
    for (int precision = 64; precision >= 32; precision -= 32)
        for (int k = -1; k <= 5; k++) {
            struct fall f;
            struct run r;
            double offset = k < 0 ? 0 : pow(10, k);
            fall_make(&f, side, offset);
            f.def.precision = precision;
            run_scene(b, &f.def, steps, &r);
            for (int p = 0; p < side * side && r.x; p++)
                r.x[p][0] -= offset;
            if (!origin.x)
                origin = r;
            fprintf(out, "%g,%d,%.3g,%lld,%lld,%s,\"%s\"\n", offset, precision,
                    run_distance(&r, &origin, side * side),
                    (long long)r.contacts, (long long)r.impacts, run_word(&r),
                    r.text);
            fflush(out);
            if (r.x != origin.x)
                run_free(&r);
            fall_free(&f);
        }
    run_free(&origin);
    fclose(out);
}

void part_drift(struct bench *b)
{
    long_runs(b);
    FILE *out = bench_csv(b, "ulp",
                          "scene,step,rms m,max m,own energy J,own differs J,"
                          "mean height m,mean differs m,lowest m,lowest "
                          "differs m");
    one_unit(b, out, true);
    one_unit(b, out, false);
    fclose(out);
    if (!b->quick)
        offsets(b);
}
