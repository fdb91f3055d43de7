/* SPDX-License-Identifier: Apache-2.0 */
/* drape run --error: finds the cheapest setting whose error is small enough, by
 * trial runs with a setting and with half its step. spec/accuracy.md §9 */
#include "app/error.h"
#include "app/app.h"

#include <math.h>
#include <stdlib.h>

/* The cheapest setting for each error, in the worst scene of the diagrams of
 * ci/bench. If a row does not suffice the next row is tried. */
static const struct setting {
    double error; /* m, the smallest error for which the row is meant */
    int integrator;
    double dt; /* s, at most */
    double tolerance;
} settings[] = {
    {2e-2, DRAPE_BW, 1.0 / 60, 1e-2},   {1e-2, DRAPE_BW, 1.0 / 120, 1e-2},
    {5e-3, DRAPE_CK, 1.0 / 240, 1e-3},  {3e-3, DRAPE_CK, 1.0 / 480, 1e-3},
    {2e-3, DRAPE_CK, 1.0 / 960, 1e-3},  {1e-3, DRAPE_CK, 1.0 / 1920, 1e-3},
    {5e-4, DRAPE_CK, 1.0 / 3840, 1e-3}, {0, DRAPE_CK, 1.0 / 7680, 1e-3},
};
enum { SETTINGS = sizeof settings / sizeof *settings, TRIAL_FRAMES = 6 };

/* The settings of a scene that a row changes. */
struct kept {
    double dt, tolerance;
    int steps_per_frame, integrator;
};

static struct kept keep(const struct scene *scene)
{
    return (struct kept){scene->def.dt, scene->def.tolerance,
                         scene->steps_per_frame, scene->def.integrator};
}

static void restore(struct scene *scene, const struct kept *own)
{
    scene->def.dt = own->dt;
    scene->def.tolerance = own->tolerance;
    scene->steps_per_frame = own->steps_per_frame;
    scene->def.integrator = own->integrator;
}

/* Divides the scene's own steps so that they are at most as long as the row's,
 * and then each into `finer` parts; with finer > 1 the tolerance is a
 * hundredth.
 */
static void apply(struct scene *scene, const struct setting *row, int finer)
{
    double own = scene->def.dt;
    int cut = (int)ceil(own / row->dt * (1 - 1e-9)) * finer;
    scene->def.dt = own / cut;
    scene->steps_per_frame *= cut;
    scene->def.integrator = row->integrator;
    scene->def.tolerance = fmax(row->tolerance * (finer > 1 ? 1e-2 : 1), 1e-12);
}

/* Runs a trial. x [n]: the cloth's positions after its frames. */
static int trial(struct scene *scene, const struct overrides *overrides,
                 int frames, double (*x)[3], bool *good)
{
    drape_world *world = NULL;
    int status = scene_create(scene, overrides, &world);
    if (status != APP_OK)
        return status;
    *good = true;
    int64_t steps = (int64_t)frames * scene->steps_per_frame;
    for (int64_t k = 0; k < steps && *good; k++) {
        drape_step_report report;
        int step = drape_step(world, &report);
        if (step != DRAPE_OK) {
            drape_destroy(world);
            return complain(APP_FAILED, "--error: trial step %lld: %s",
                            (long long)k + 1, drape_status_text(step));
        }
        *good = !(report.outcome & (DRAPE_DIVERGED | DRAPE_TRAPPED));
    }
    int read = drape_read(world, x, NULL);
    drape_destroy(world);
    return read == DRAPE_OK
               ? APP_OK
               : complain(APP_FAILED, "--error: %s", drape_status_text(read));
}

static int64_t count_vertices(const drape_def *def, bool cloth_only)
{
    int64_t n = 0;
    for (int k = 0; k < def->n_cloths; k++)
        n += (int64_t)def->cloths[k].m * def->cloths[k].n;
    for (int k = 0; k < def->n_obstacles && !cloth_only; k++)
        n += def->obstacles[k].n_vertices;
    return n;
}

static double distance(int64_t n, double (*x)[3], double (*y)[3])
{
    double sum = 0;
    for (int64_t p = 0; p < n; p++)
        for (int k = 0; k < 3; k++)
            sum += (x[p][k] - y[p][k]) * (x[p][k] - y[p][k]);
    return sqrt(sum / (double)n);
}

/* The error of a row: twice the distance between the runs with the step and
 * with half the step. The finer run's error is about half as large for a method
 * of order 1, and smaller for a higher order, so this is an upper estimate. */
static int measure(struct scene *scene, const struct overrides *overrides,
                   const struct setting *row, double (*x[2])[3], double *error)
{
    struct kept own = keep(scene);
    int64_t n = count_vertices(&scene->def, true);
    int frames = scene->frames < TRIAL_FRAMES ? scene->frames : TRIAL_FRAMES;
    int status = APP_OK;
    bool good[2] = {false, false};
    for (int k = 0; k < 2 && status == APP_OK; k++) {
        apply(scene, row, k + 1);
        status = trial(scene, overrides, frames, x[k], &good[k]);
        restore(scene, &own);
    }
    *error = good[0] && good[1] ? 2 * distance(n, x[0], x[1]) : INFINITY;
    return status;
}

static int search(struct scene *scene, const struct overrides *overrides,
                  double (*x[2])[3], struct estimate *e)
{
    int k = 0;
    while (k + 1 < SETTINGS && settings[k].error > e->asked)
        k++;
    for (; k < SETTINGS; k++) {
        int status = measure(scene, overrides, &settings[k], x, &e->error);
        if (status != APP_OK)
            return status;
        if (!(e->error <= e->asked))
            continue;
        apply(scene, &settings[k], 1);
        return APP_OK;
    }
    if (!(e->error < INFINITY))
        return complain(APP_FINDINGS,
                        "--error %g: not reached; the trial runs intersect or "
                        "diverge at the finest setting too",
                        e->asked);
    return complain(APP_FINDINGS,
                    "--error %g: not reached; the finest setting, dt %.3g s, "
                    "has %.3g m",
                    e->asked, settings[SETTINGS - 1].dt, e->error);
}

int error_choose(struct scene *scene, const struct overrides *overrides,
                 double asked, struct estimate *estimate)
{
    /* one more than needed, since malloc(0) may return NULL */
    size_t n = (size_t)count_vertices(&scene->def, false) + 1;
    double(*x[2])[3] = {malloc(n * sizeof *x[0]), malloc(n * sizeof *x[1])};
    int frames = scene->frames < TRIAL_FRAMES ? scene->frames : TRIAL_FRAMES;
    *estimate = (struct estimate){.asked = asked};
    estimate->horizon = frames * scene->steps_per_frame * scene->def.dt;
    int status = x[0] && x[1] ? search(scene, overrides, x, estimate)
                              : complain(APP_FAILED, "--error: out of memory");
    free(x[0]);
    free(x[1]);
    return status;
}
