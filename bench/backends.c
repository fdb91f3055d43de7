/* SPDX-License-Identifier: Apache-2.0 */
/* Runs the same settings on the reference and on a device. The bits must be
 * equal, so the errors are, and only the times differ. spec/accuracy.md §1 */
#include "bench/accuracy.h"

#include <string.h>

static const double TIME = 0.1; /* s, length of a run */

static const struct setting {
    int integrator, steps;
    double tolerance;
} settings[] = {
    {DRAPE_EULER, 6, 1e-3}, {DRAPE_VERLET, 6, 1e-3}, {DRAPE_BW, 6, 1e-2},
    {DRAPE_BW, 24, 1e-2},   {DRAPE_BW, 96, 1e-2},    {DRAPE_BW, 6, 1e-3},
    {DRAPE_BW, 24, 1e-3},   {DRAPE_BW, 96, 1e-3},    {DRAPE_CK, 6, 1e-3},
    {DRAPE_CK, 24, 1e-3},   {DRAPE_CK, 96, 1e-3},    {DRAPE_CK, 192, 1e-3},
};
enum { SETTINGS = sizeof settings / sizeof *settings };

static void row(struct bench *b, FILE *out, struct sample *s,
                const struct run *exact)
{
    struct run r[2];
    const drape_def *d = &s->def;
    int64_t n = (int64_t)s->cloth.m * s->cloth.m;
    for (int k = DRAPE_REF; k <= DRAPE_GPU; k++) {
        b->backend = k;
        run_scene(b, d, (int64_t)(TIME / d->dt + 0.5), &r[k]);
        fprintf(out, "%d,%s,%s,%d,%g,%.6g,%d,%lld,%.4g,%.3e,%s\n", s->cloth.m,
                backend_name[k], integrator_name[d->integrator], d->precision,
                d->integrator < DRAPE_BW ? 0 : d->tolerance, d->dt,
                r[k].substeps, (long long)r[k].iterations, r[k].seconds,
                run_distance(&r[k], exact, n), run_word(&r[k]));
    }
    fflush(out);
    bool same = r[0].n == r[1].n && r[0].x && r[1].x &&
                !memcmp(r[0].x, r[1].x, (size_t)r[0].n * sizeof *r[0].x);
    bench_check(b, same, "%d particles a side, %s: the backends differ",
                s->cloth.m, integrator_name[d->integrator]);
    run_free(&r[0]);
    run_free(&r[1]);
}

/* Runs all settings on one grid; on a fine grid only the implicit ones, since
 * explicit ones take too many substeps for the reference. */
static void grid(struct bench *b, FILE *out, int side, int fine)
{
    int first = side > 25 ? DRAPE_BW : DRAPE_EULER;
    struct sample s;
    struct run exact;
    sample_make(&s, SAMPLE_HANGING, side);
    s.cloth.material.damping = 1e-3;
    b->backend = DRAPE_GPU;
    double d = run_converged(b, &s, TIME, fine, &exact);
    fprintf(out, "%d,gpu,converged,64,,%.6g,,,%.4g,%.3e,\n", side, s.def.dt,
            exact.seconds, d);
    for (int k = 0; k < SETTINGS; k++)
        for (int bits = 32; bits <= 64; bits += 32) {
            s.def.integrator = settings[k].integrator;
            s.def.dt = TIME / settings[k].steps;
            s.def.tolerance = settings[k].tolerance;
            s.def.precision = bits;
            bool explicit = s.def.integrator < DRAPE_BW;
            if (s.def.integrator >= first && (explicit || bits == 32))
                row(b, out, &s, &exact);
        }
    run_free(&exact);
    sample_free(&s);
}

/* Times are wall times on both backends; the reference runs on one thread. */
void part_backends(struct bench *b)
{
    if (b->backend != DRAPE_GPU)
        return;
    FILE *out = bench_csv(b, "backends",
                          "side,backend,integrator,precision,tolerance,dt,"
                          "substeps,iterations,seconds,rms m,end");
    b->wall = true;
    grid(b, out, b->quick ? 9 : 25, b->quick ? 768 : 3072);
    if (!b->quick)
        grid(b, out, 129, 12288);
    b->backend = DRAPE_GPU;
    b->wall = false;
    fclose(out);
}
