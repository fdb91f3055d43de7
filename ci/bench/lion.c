/* SPDX-License-Identifier: Apache-2.0 */
/* Run time against error with contact: a shipped scene at a short horizon.
 * spec/accuracy.md §1 */
#include "app/scene.h"
#include "ci/bench/accuracy.h"

#include <math.h>
#include <stdlib.h>

#define SCENE "app/scenes/lion_20k.json"
static const double TIME = 0.3; /* s: 18 steps of 1/60 s */

static const struct setting {
    int integrator, each; /* steps of 1/60 s are cut into so many */
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
enum { SETTINGS = sizeof settings / sizeof *settings };

static void set(drape_def *d, const struct setting *a)
{
    d->integrator = a->integrator;
    d->dt = 1.0 / 60 / a->each;
    d->tolerance = a->tolerance;
    d->precond = a->precond;
    d->precision = a->precision;
}

static void row(struct bench *b, FILE *out, const struct setting *a,
                drape_def *def, const struct run *exact)
{
    struct run r;
    int64_t n = (int64_t)def->cloths[0].m * def->cloths[0].n;
    set(def, a);
    run_scene(b, def, (int)(TIME * 60 + 0.5) * a->each, &r);
    double height = 0;
    for (int64_t p = 0; p < n && exact->x && r.x; p++)
        height += (r.x[p][1] - exact->x[p][1]) / (double)n;
    fprintf(out, "%s,%s,%d,%s,%g,%.6g,%lld,%.4g,%.3e,%.3e,%.3e,%s\n",
            backend_name[b->backend], integrator_name[a->integrator],
            a->precision, precond_name[a->precond], a->tolerance, def->dt,
            (long long)r.iterations, r.seconds, run_distance(&r, exact, n),
            fabs(height), fabs(r.energy - exact->energy), run_word(&r));
    fflush(out);
    run_free(&r);
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
                          "iterations,seconds,rms m,mean height m,energy J,"
                          "end");
    struct run exact[2];
    drape_def *d = &scene.def;
    d->threads = 1;
    int64_t n = (int64_t)d->cloths[0].m * d->cloths[0].n;
    for (int k = 0; k < 2; k++) { /* how far the converged run is from that */
        struct setting finest = {DRAPE_BW, 16 << k, 1e-5, DRAPE_MULTIGRID, 64};
        set(d, &finest);
        run_scene(b, d, (int)(TIME * 60 + 0.5) * (16 << k), &exact[k]);
    }
    fprintf(out, "%s,converged,64,multigrid,1e-05,%.6g,%lld,%.4g,%.3e,,,%s\n",
            backend_name[b->backend], d->dt, (long long)exact[1].iterations,
            exact[1].seconds, run_distance(&exact[0], &exact[1], n),
            run_word(&exact[1]));
    fflush(out);
    for (int k = 0; k < SETTINGS; k++)
        row(b, out, &settings[k], d, &exact[1]);
    for (int k = 0; k < 2; k++)
        run_free(&exact[k]);
    fclose(out);
    scene_free(&scene);
}
