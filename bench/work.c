/* SPDX-License-Identifier: Apache-2.0 */
/* Measures run time against error, without contact. spec/accuracy.md §1 */
#include "bench/accuracy.h"

#include <math.h>
#include <string.h>

static const double TIME = 0.1; /* s, length of a run: 6 steps of 1/60 s */

/* Errors of a run compared with the converged run. */
struct error {
    double rms, most; /* m, of positions: root mean square, largest */
    double energy;    /* J */
    double strain;    /* of the strain of the grid's edges, root mean square */
    double pin;       /* m, the largest distance of a pin from its place */
};

static double length(const double a[3], const double b[3])
{
    double x = a[0] - b[0], y = a[1] - b[1], z = a[2] - b[2];
    return sqrt(x * x + y * y + z * z);
}

static double edge_error(const struct run *r, const struct run *to, int side)
{
    double sum = 0;
    int n = side * side, edges = 0;
    for (int p = 0; p < n; p++)
        for (int k = 0; k < 2; k++) {
            int q = k ? p + side : p + 1;
            if (k ? q >= n : q % side == 0)
                continue;
            double d = length(r->x[p], r->x[q]) - length(to->x[p], to->x[q]);
            d *= side - 1; /* to a strain: an edge is 1 / (side - 1) m long */
            sum += d * d;
            edges++;
        }
    return sqrt(sum / edges);
}

static struct error measure(const struct sample *s, const struct run *r,
                            const struct run *to)
{
    int side = s->cloth.m;
    struct error e = {.rms = run_distance(r, to, side * side),
                      .energy = fabs(r->energy - to->energy),
                      .strain = edge_error(r, to, side)};
    for (int p = 0; p < side * side; p++)
        e.most = fmax(e.most, length(r->x[p], to->x[p]));
    for (int k = 0; k < s->cloth.n_pins; k++) {
        int p = s->pin[k].i + side * s->pin[k].j;
        e.pin = fmax(e.pin, length(r->x[p], s->x[p]));
    }
    return e;
}

double run_converged(struct bench *b, struct sample *s, double time, int steps,
                     struct run *to)
{
    struct run coarse;
    s->def.precision = 64;
    s->def.integrator = DRAPE_RK4;
    s->def.dt = 2 * time / steps;
    run_scene(b, &s->def, steps / 2, &coarse);
    s->def.dt = time / steps;
    run_scene(b, &s->def, steps, to);
    bench_check(b, !to->status && !to->outcome, "the converged run: %s",
                run_word(to));
    double d = run_distance(&coarse, to, (int64_t)s->cloth.m * s->cloth.m);
    run_free(&coarse);
    return d;
}

struct diagram {
    const char *name;
    enum sample_kind kind;
    double damping;
};
static const struct diagram diagrams[] = {
    {"stretched", SAMPLE_STRETCHED, 1e-3},
    {"hanging", SAMPLE_HANGING, 1e-3},
    {"flag", SAMPLE_FLAG, 1e-3},
};
enum { DIAGRAMS = sizeof diagrams / sizeof *diagrams };

/* The settings of the implicit curves. The first one is the default. */
static const struct setting {
    int precision, precond;
    double tolerance;
} settings[] = {
    {32, DRAPE_MULTIGRID, 1e-3}, {32, DRAPE_MULTIGRID, 1e-2},
    {32, DRAPE_MULTIGRID, 1e-5}, {32, DRAPE_JACOBI, 1e-2},
    {32, DRAPE_JACOBI, 1e-3},    {32, DRAPE_JACOBI, 1e-5},
    {64, DRAPE_MULTIGRID, 1e-3}, {64, DRAPE_MULTIGRID, 1e-8},
};
enum { SETTINGS = sizeof settings / sizeof *settings };

struct table {
    struct bench *b;
    FILE *out;
    const char *name;
    struct sample sample;
    struct run exact;
};

static void point(struct table *t, int steps)
{
    struct run r;
    struct sample *s = &t->sample;
    const drape_def *d = &s->def;
    bool implicit = d->integrator >= DRAPE_BW;
    s->def.dt = TIME / steps;
    run_scene(t->b, d, steps, &r);
    fprintf(t->out, "%s,%s,%s,%d,%s,%g,%.9g,%d,%d,%lld,%.4g,", t->name,
            backend_name[t->b->backend], integrator_name[d->integrator],
            d->precision, implicit ? precond_name[d->precond] : "",
            implicit ? d->tolerance : 0, d->dt, steps, r.substeps,
            (long long)r.iterations, r.seconds);
    if (r.status == DRAPE_OK && r.steps == steps) {
        struct error e = measure(s, &r, &t->exact);
        fprintf(t->out, "%.3e,%.3e,%.3e,%.3e,%.3e,%s\n", e.rms, e.most,
                e.energy, e.strain, e.pin, run_word(&r));
    } else
        fprintf(t->out, ",,,,,%s\n", run_word(&r));
    fflush(t->out);
    run_free(&r);
}

static void curves(struct table *t)
{
    static const int fine[] = {6, 384, 768, 1536, 3072};
    struct sample *s = &t->sample;
    int last = t->b->quick ? 1 : 5;
    for (int m = DRAPE_EULER; m <= DRAPE_RK4; m++)
        for (int precision = 32; precision <= 64; precision += 32)
            for (int k = 0; k < last; k++) {
                s->def.integrator = m;
                s->def.precision = precision;
                point(t, fine[k]);
            }
    for (int m = DRAPE_BW; m <= DRAPE_CK; m++)
        for (int c = 0; c < SETTINGS; c++)
            for (int k = 0; k <= last; k++) {
                s->def.integrator = m;
                s->def.precision = settings[c].precision;
                s->def.precond = settings[c].precond;
                s->def.tolerance = settings[c].tolerance;
                point(t, 6 << k);
            }
}

void part_work(struct bench *b)
{
    FILE *out = bench_csv(
        b, "work",
        "scene,backend,integrator,precision,precond,tolerance,dt,steps,"
        "substeps,iterations,seconds,rms m,max m,energy J,strain,pin m,end");
    int side = b->quick ? 9 : 25;
    for (int k = 0; k < (b->quick ? 1 : DIAGRAMS); k++) {
        struct table t = {.b = b, .out = out, .name = diagrams[k].name};
        sample_make(&t.sample, diagrams[k].kind, side);
        t.sample.cloth.material.damping = diagrams[k].damping;
        double d =
            run_converged(b, &t.sample, TIME, b->quick ? 768 : 6144, &t.exact);
        fprintf(out, "%s,%s,converged,64,,,,,,,%.4g,%.3e,,,,,\n",
                diagrams[k].name, backend_name[b->backend], t.exact.seconds, d);
        curves(&t);
        run_free(&t.exact);
        sample_free(&t.sample);
    }
    fclose(out);
}
