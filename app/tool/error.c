/* SPDX-License-Identifier: Apache-2.0 */
/* drape run --error: finds the cheapest setting whose error is small enough
 * over the whole run, by trial runs with a setting and with half its step.
 * spec/accuracy.md §9 */
#include "app/scene/error.h"
#include "app/base/app.h"

#include <math.h>
#include <stdlib.h>

/* The cheapest setting for each error, in the worst scene of the diagrams of
 * bench. If a row does not suffice the next row is tried. */
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
enum { SETTINGS = sizeof settings / sizeof *settings };
/* Frames for which a setting must hold, at least, where none holds to the end.
 */
enum { LEAST_FRAMES = 6 };

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

/* A run with a setting, and the same with half its step. */
struct pair {
    drape_world *world[2];
    int steps[2]; /* a frame */
    double (*x[2])[3];
    int64_t n; /* vertices of cloth */
};

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

static int make_worlds(struct scene *scene, const struct overrides *overrides,
                       const struct setting *row, struct pair *pair)
{
    struct kept own = keep(scene);
    int status = APP_OK;
    for (int k = 0; k < 2 && status == APP_OK; k++) {
        apply(scene, row, k + 1);
        pair->steps[k] = scene->steps_per_frame;
        status = scene_create(scene, overrides, &pair->world[k]);
        restore(scene, &own);
    }
    return status;
}

/* Makes a frame of one of the two; *good: it neither intersects nor diverges.
 */
static int make_frame(struct pair *pair, int k, bool *good)
{
    int status = DRAPE_OK;
    for (int i = 0; i < pair->steps[k] && status == DRAPE_OK && *good; i++) {
        drape_step_report report;
        status = drape_step(pair->world[k], &report);
        *good = status == DRAPE_OK &&
                !(report.outcome & (DRAPE_DIVERGED | DRAPE_TRAPPED));
    }
    if (status == DRAPE_OK)
        status = drape_read(pair->world[k], pair->x[k], NULL);
    return status == DRAPE_OK ? APP_OK
                              : complain(APP_FAILED, "--error: a trial: %s",
                                         drape_status_text(status));
}

/* How long a setting holds, and what it has. */
struct trial {
    int frames;    /* for which the estimate is at most what is asked */
    double error;  /* m, the largest estimate of these frames */
    double beyond; /* m, of the frame after them, if it does not hold for all */
};

/* Tries a row. The error is twice the distance between the runs with the step
 * and with half the step. The finer run's error is about half as large for a
 * method of order 1, and smaller for a higher order, so this is an upper
 * estimate. */
static int measure(struct scene *scene, const struct overrides *overrides,
                   const struct setting *row, double asked, struct pair *pair,
                   struct trial *t)
{
    *t = (struct trial){0};
    int status = make_worlds(scene, overrides, row, pair);
    while (status == APP_OK && t->frames < scene->frames) {
        bool good = true;
        for (int k = 0; k < 2 && status == APP_OK && good; k++)
            status = make_frame(pair, k, &good);
        double error =
            good ? 2 * distance(pair->n, pair->x[0], pair->x[1]) : INFINITY;
        t->beyond = error;
        if (!(error <= asked))
            break;
        t->error = fmax(t->error, error);
        t->frames++;
    }
    for (int k = 0; k < 2; k++) {
        drape_destroy(pair->world[k]);
        pair->world[k] = NULL;
    }
    return status;
}

static double frame_time(const struct scene *scene)
{
    return scene->steps_per_frame * scene->def.dt;
}

static int refuse(const struct estimate *e, const struct trial *last)
{
    if (!(last->beyond < INFINITY))
        return complain(APP_FINDINGS,
                        "--error %g: not reached; the trial runs intersect or "
                        "diverge at the finest setting too",
                        e->asked);
    return complain(APP_FINDINGS,
                    "--error %g: not reached; the finest setting, dt %.3g s, "
                    "has %.3g m",
                    e->asked, settings[SETTINGS - 1].dt, last->beyond);
}

/* Takes the first setting that holds to the end. Else the one that holds for
 * longest, once a finer one holds no longer: then things part that no setting
 * would keep together. */
static int search(struct scene *scene, const struct overrides *overrides,
                  struct pair *pair, struct estimate *e)
{
    int k = 0, best = -1, held = 0;
    int least = scene->frames < LEAST_FRAMES ? scene->frames : LEAST_FRAMES;
    struct trial t;
    while (k + 1 < SETTINGS && settings[k].error > e->asked)
        k++;
    for (; k < SETTINGS; k++) {
        int status =
            measure(scene, overrides, &settings[k], e->asked, pair, &t);
        if (status != APP_OK)
            return status;
        bool longer = best < 0 || t.frames > held;
        if (!longer && held >= least)
            break;
        if (longer) {
            best = k;
            held = t.frames;
            e->error = t.error;
        }
        if (held == scene->frames)
            break;
    }
    if (held < least)
        return refuse(e, &t);
    e->horizon = held * frame_time(scene);
    apply(scene, &settings[best], 1);
    return APP_OK;
}

int error_choose(struct scene *scene, const struct overrides *overrides,
                 double asked, struct estimate *estimate)
{
    /* one more than needed, since malloc(0) may return NULL */
    size_t n = (size_t)count_vertices(&scene->def, false) + 1;
    struct pair pair = {.n = count_vertices(&scene->def, true)};
    for (int k = 0; k < 2; k++)
        pair.x[k] = malloc(n * sizeof *pair.x[k]);
    *estimate = (struct estimate){.asked = asked};
    int status = pair.x[0] && pair.x[1]
                     ? search(scene, overrides, &pair, estimate)
                     : complain(APP_FAILED, "--error: out of memory");
    free(pair.x[0]);
    free(pair.x[1]);
    return status;
}
