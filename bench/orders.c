/* SPDX-License-Identifier: Apache-2.0 */
/* Measures orders of convergence from the errors at a step and at half of it.
 * spec/accuracy.md §2 */
#include "bench/accuracy.h"

#include <math.h>

struct fit {
    enum sample_kind kind;
    double damping;
    int integrator;
    double theory; /* the order to check; 0: theory gives none */
    int steps;     /* of the coarser of two runs */
};

/* The orders are from spec/cloth/implicit.md §5 for Choi–Ko and from advance.md
 * for the others. Where springs cross kinks of the force law, or where the wind
 * is that of the step's start, theory gives no order. */
static const struct fit fits[] = {
    {SAMPLE_STRETCHED, 0, DRAPE_EULER, 1, 2048},
    {SAMPLE_STRETCHED, 0, DRAPE_VERLET, 2, 1024},
    {SAMPLE_STRETCHED, 0, DRAPE_RK4, 4, 512},
    {SAMPLE_STRETCHED, 0, DRAPE_BW, 1, 4096},
    {SAMPLE_STRETCHED, 0, DRAPE_CK, 2, 1024},
    {SAMPLE_STRETCHED, 1e-4, DRAPE_EULER, 1, 2048},
    {SAMPLE_STRETCHED, 1e-4, DRAPE_MIDPOINT, 2, 1024},
    {SAMPLE_STRETCHED, 1e-4, DRAPE_VERLET, 2, 1024},
    {SAMPLE_STRETCHED, 1e-4, DRAPE_RK4, 4, 512},
    {SAMPLE_STRETCHED, 1e-4, DRAPE_BW, 1, 4096},
    {SAMPLE_STRETCHED, 1e-4, DRAPE_CK, 0, 2048},
    {SAMPLE_HANGING, 1e-4, DRAPE_EULER, 0, 2048},
    {SAMPLE_HANGING, 1e-4, DRAPE_VERLET, 0, 1024},
    {SAMPLE_HANGING, 1e-4, DRAPE_RK4, 0, 1024},
    {SAMPLE_HANGING, 1e-4, DRAPE_BW, 0, 2048},
    {SAMPLE_HANGING, 1e-4, DRAPE_CK, 0, 2048},
    {SAMPLE_FLAG, 1e-4, DRAPE_EULER, 0, 2048},
    {SAMPLE_FLAG, 1e-4, DRAPE_VERLET, 0, 1024},
    {SAMPLE_FLAG, 1e-4, DRAPE_RK4, 0, 1024},
    {SAMPLE_FLAG, 1e-4, DRAPE_BW, 0, 2048},
    {SAMPLE_FLAG, 1e-4, DRAPE_CK, 0, 2048},
};
enum { FITS = sizeof fits / sizeof *fits };

static double fit_order(struct bench *b, struct sample *s, const struct fit *f,
                        double time, const struct run *to, double error[2])
{
    s->def.integrator = f->integrator;
    s->def.tolerance = 1e-12;
    int64_t n = (int64_t)s->cloth.m * s->cloth.m;
    for (int k = 0; k < 2; k++) {
        struct run r;
        /* the quick form has a coarser grid, half the time and longer steps */
        int steps = (b->quick ? f->steps / 8 : f->steps) << k;
        s->def.dt = time / steps;
        run_scene(b, &s->def, steps, &r);
        error[k] = r.outcome & ~DRAPE_UNCONVERGED || r.substeps != 1
                       ? NAN
                       : run_distance(&r, to, n);
        run_free(&r);
    }
    return log2(error[0] / error[1]);
}

/* Whether two rows have the same scene and damping, and so share a converged
 * run. */
static bool same(const struct fit *a, const struct fit *b)
{
    return a->kind == b->kind && a->damping == b->damping;
}

static void fit_scene(struct bench *b, FILE *out, const struct fit *first)
{
    double time = b->quick ? 0.02 : 0.04, error[2];
    struct sample s;
    struct run to;
    sample_make(&s, first->kind, b->quick ? 6 : 9);
    s.cloth.material.damping = first->damping;
    run_converged(b, &s, time, b->quick ? 2048 : 8192, &to);
    for (const struct fit *f = first; f < fits + FITS && same(f, first); f++) {
        if (b->quick && !f->theory)
            continue;
        double order = fit_order(b, &s, f, time, &to, error);
        fprintf(out, "%s,%g,%s,%d,%.3e,%.3e,%.3f,%g\n", sample_name[f->kind],
                f->damping, integrator_name[f->integrator],
                b->quick ? f->steps / 8 : f->steps, error[0], error[1], order,
                f->theory);
        fflush(out);
        bench_check(b, !f->theory || fabs(order - f->theory) <= 0.1,
                    "order of %s, %s, damping %g: %.3f, theory %g",
                    integrator_name[f->integrator], sample_name[f->kind],
                    f->damping, order, f->theory);
    }
    run_free(&to);
    sample_free(&s);
}

void part_orders(struct bench *b)
{
    FILE *out = bench_csv(b, "orders",
                          "scene,damping,integrator,steps,rms m,rms m at twice "
                          "the steps,order,theory");
    for (int k = 0; k < FITS; k++)
        if (k == 0 || !same(&fits[k], &fits[k - 1]))
            if (!b->quick || fits[k].theory)
                fit_scene(b, out, &fits[k]);
    fclose(out);
}
