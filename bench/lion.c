/* SPDX-License-Identifier: Apache-2.0 */
/* Measures run time against error with contact, on a scene of the tool for a
 * short time. spec/accuracy.md §1 */
#include "app/scene/scene.h"
#include "bench/accuracy.h"

#include <math.h>

#define SCENE "app/scenes/lion_20k.json"
static const double TIME = 0.3; /* s: 18 steps of 1/60 s */

static const struct setting {
    int integrator, each; /* each: steps in 1/60 s */
    double tolerance;
    int precond, precision;
} settings[] = {
    {DRAPE_BW, 1, 1e-3, DRAPE_MULTIGRID, 32}, /* the default */
    {DRAPE_BW, 1, 1e-2, DRAPE_MULTIGRID, 32},
    {DRAPE_BW, 1, 1e-4, DRAPE_MULTIGRID, 32},
    {DRAPE_BW, 1, 1e-5, DRAPE_MULTIGRID, 32},
    {DRAPE_BW, 1, 1e-3, DRAPE_JACOBI, 32},
    {DRAPE_BW, 1, 1e-3, DRAPE_MULTIGRID, 64},
    {DRAPE_BW, 2, 1e-3, DRAPE_MULTIGRID, 32},
    {DRAPE_BW, 2, 1e-5, DRAPE_MULTIGRID, 32},
    {DRAPE_BW, 4, 1e-3, DRAPE_MULTIGRID, 32},
    {DRAPE_CK, 1, 1e-3, DRAPE_MULTIGRID, 32},
    {DRAPE_CK, 1, 1e-5, DRAPE_MULTIGRID, 32},
    {DRAPE_CK, 2, 1e-3, DRAPE_MULTIGRID, 32},
    {DRAPE_CK, 4, 1e-3, DRAPE_MULTIGRID, 32},
};
enum { SETTINGS = sizeof settings / sizeof *settings, RUNS = 3 };

static void set(drape_def *d, const struct setting *a)
{
    d->integrator = a->integrator;
    d->dt = 1.0 / 60 / a->each;
    d->tolerance = a->tolerance;
    d->precond = a->precond;
    d->precision = a->precision;
}

/* The runs of a setting, whose gravity differs by a few last bits. Differences
 * between settings that are within the spread of these runs are due to chaos.
 */
struct points {
    double seconds, rms; /* means */
    double least, most;  /* of rms */
    int64_t iterations;  /* mean number of solver iterations: a measure of
                            work that needs no clock */
};

static struct points row(struct bench *b, FILE *out, const struct setting *a,
                         drape_def *def, const struct run *exact)
{
    struct points p = {0, 0, INFINITY, 0, 0};
    double height = 0, energy = 0;
    int64_t n = (int64_t)def->cloths[0].m * def->cloths[0].n;
    int outcome = 0;
    set(def, a);
    for (int k = 0; k < RUNS; k++) {
        struct run r;
        def->gravity[1] = -9.81 * (1 + 2e-7 * k);
        run_scene(b, def, (int)(TIME * 60 + 0.5) * a->each, &r);
        double rms = run_distance(&r, exact, n);
        p.seconds += r.seconds / RUNS;
        p.rms += rms / RUNS;
        p.least = fmin(p.least, rms);
        p.most = fmax(p.most, rms);
        for (int64_t i = 0; i < n && exact->x && r.x; i++)
            height += (r.x[i][1] - exact->x[i][1]) / (double)(n * RUNS);
        energy += (r.energy - exact->energy) / RUNS;
        p.iterations += r.iterations / RUNS;
        outcome |= r.outcome;
        run_free(&r);
    }
    struct run all = {.outcome = outcome, .finite = true, .steps = 1};
    fprintf(out, "%s,%s,%d,%s,%g,%.6g,%lld,%.4g,%.3e,%.3e,%.3e,%.3e,%.3e,%s\n",
            backend_name[b->backend], integrator_name[a->integrator],
            a->precision, precond_name[a->precond], a->tolerance, def->dt,
            (long long)p.iterations, p.seconds, p.rms, p.least, p.most,
            fabs(height), fabs(energy), run_word(&all));
    fflush(out);
    return p;
}

/* Makes the converged run, and writes its distance from a run of twice the
 * step. */
static void converge(struct bench *b, FILE *out, drape_def *d,
                     struct run *exact)
{
    struct run coarse;
    int64_t n = (int64_t)d->cloths[0].m * d->cloths[0].n;
    struct setting finest = {DRAPE_BW, 16, 1e-5, DRAPE_MULTIGRID, 64};
    set(d, &finest);
    run_scene(b, d, (int)(TIME * 60 + 0.5) * finest.each, &coarse);
    finest.each *= 2;
    set(d, &finest);
    run_scene(b, d, (int)(TIME * 60 + 0.5) * finest.each, exact);
    fprintf(out, "%s,converged,64,multigrid,1e-05,%.6g,%lld,%.4g,%.3e,,,,,%s\n",
            backend_name[b->backend], d->dt, (long long)exact->iterations,
            exact->seconds, run_distance(&coarse, exact, n), run_word(exact));
    fflush(out);
    run_free(&coarse);
}

/* Checks that no setting beats the first one, the default, in both work and
 * error by more than the spread of the runs. Work is counted in iterations, as
 * times differ from run to run; they are in the table. */
static void compare(struct bench *b, const struct points *p)
{
    for (int k = 1; k < SETTINGS; k++)
        bench_check(
            b, p[k].iterations >= p[0].iterations || p[k].most >= p[0].least,
            "lion: the default takes %lld iterations for %g m, "
            "setting %d %lld for %g m at most",
            (long long)p[0].iterations, p[0].least, k,
            (long long)p[k].iterations, p[k].most);
}

void part_lion(struct bench *b)
{
    if (b->quick)
        return;
    struct scene scene;
    if (scene_load(&scene, SCENE) != 0) {
        printf("skipped: %s or its mesh is not here\n", SCENE);
        scene_free(&scene);
        return;
    }
    FILE *out = bench_csv(b, "lion",
                          "backend,integrator,precision,precond,tolerance,dt,"
                          "iterations,seconds,rms m,least m,most m,mean height "
                          "m,energy J,end");
    struct run exact;
    struct points p[SETTINGS];
    scene.def.threads = 1;
    converge(b, out, &scene.def, &exact);
    for (int k = 0; k < SETTINGS; k++)
        p[k] = row(b, out, &settings[k], &scene.def, &exact);
    compare(b, p);
    run_free(&exact);
    fclose(out);
    scene_free(&scene);
}
