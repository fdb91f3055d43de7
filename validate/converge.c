/* SPDX-License-Identifier: Apache-2.0 */
/* A strip that falls on a drum and slides off it: whether motion with contact
 * converges. spec/validation.md §17 */
#include "validate/pile.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { TIMES = 2, ALONG = 21, ACROSS = 3, SAMPLES = ALONG * ACROSS };
static const double times[TIMES] = {0.15, 0.3};

/* Places of the strip's material points at the two times, m. */
struct path {
    double x[TIMES][SAMPLES][3];
    bool good;
};

/* A strip of 0.4 × 0.05 m falls by 20 mm on a drum of 80 mm radius, 30 mm off
 * its middle. */
static void drop(const struct validate *v, const struct scheme *how,
                 double cell, double dt, int until, struct path *out)
{
    struct pile p;
    int m = (int)(0.4 / cell + 0.5) + 1, n = (int)(0.05 / cell + 0.5) + 1;
    pile_make(v, &p, how, dt);
    p.material.bend = 1e-4;
    pile_sheet(&p, m, n, cell, (double[3]){-0.17, 0.08 + 0.001 + 0.02, -0.025});
    p.cloth[0].material.thickness = 1e-3;
    pile_drum(&p, 0.08, 0.1, 256, 0.3);
    out->good = pile_start(&p);
    for (int t = 0; t < until; t++) {
        out->good = out->good && pile_until(&p, times[t]);
        for (int k = 0; out->good && k < SAMPLES; k++) {
            int i = k % ALONG * (m - 1) / (ALONG - 1);
            int j = k / ALONG * (n - 1) / (ACROSS - 1);
            memcpy(out->x[t][k], p.x[i + m * j], sizeof out->x[t][k]);
        }
    }
    pile_free(&p);
}

/* The rms distance of the points of two paths at a time; NAN: none. */
static double apart(const struct path *a, const struct path *b, int t)
{
    double sum = 0;
    for (int k = 0; k < SAMPLES; k++)
        for (int c = 0; c < 3; c++)
            sum += pow(a->x[t][k][c] - b->x[t][k][c], 2);
    return a->good && b->good ? sqrt(sum / SAMPLES) : NAN;
}

/* The slope of errors over sizes on logarithmic scales. */
static double order(int n, const double *size, const double *error)
{
    double sx = 0, sy = 0, xx = 0, xy = 0;
    for (int k = 0; k < n; k++) {
        double x = log(size[k]), y = log(error[k]);
        sx += x;
        sy += y;
        xx += x * x;
        xy += x * y;
    }
    return (n * xy - sx * sy) / (n * xx - sx * sx);
}

/* Errors at several sizes, and their order, at each time. */
static void rows(struct validate *v, const char *what, int n,
                 const double *size, const struct path *path,
                 const struct path *fine, int until)
{
    for (int t = 0; t < until; t++) {
        char name[2][128];
        double error[SIZES];
        snprintf(name[0], sizeof name[0], "%s; rms error at %g s", what,
                 times[t]);
        snprintf(name[1], sizeof name[1],
                 "%s; order of the error at %g s; to 1", what, times[t]);
        struct property p = pile_row("converge", name[0], "m", 0, NAN);
        struct property q = pile_row("converge", name[1], "1", 1, 0.2);
        q.promised = false;
        for (int k = 0; k < n; k++) {
            error[k] = apart(&path[k], fine, t);
            property_add(&p, size[k], error[k]);
        }
        property_add(&q, size[n - 1], fmin(1, order(n, size, error)));
        property_end(v, &p);
        property_end(v, &q);
    }
}

void part_converge(struct validate *v)
{
    static const double steps[] = {1.0 / 60, 1.0 / 120, 1.0 / 240, 1.0 / 480};
    static const double cells[] = {0.01, 0.005, 0.0025};
    static const struct scheme best = {"bdf2", DRAPE_BDF2, 0};
    struct path fine, path[SIZES];
    char name[96];
    if (v->bits == 32)
        return;
    int until = v->quick ? 1 : TIMES;
    drop(v, &best, 0.01, v->quick ? 1.0 / 960 : 1.0 / 1920, until, &fine);
    for (int s = 0; s < (v->quick ? 1 : SCHEMES); s++) {
        for (int k = 0; k < 4; k++)
            drop(v, &schemes[s], 0.01, steps[k], until, &path[k]);
        snprintf(name, sizeof name, "%s; by steps", schemes[s].name);
        rows(v, name, 4, steps, path, &fine, until);
    }
    if (v->quick)
        return;
    /* By cells, from those of half the size of the finest. */
    drop(v, &best, 0.00125, 1.0 / 240, until, &fine);
    for (int k = 0; k < 3; k++)
        drop(v, &best, cells[k], 1.0 / 240, until, &path[k]);
    rows(v, "bdf2; by cells", 3, cells, path, &fine, until);
}
