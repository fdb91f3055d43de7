/* SPDX-License-Identifier: Apache-2.0 */
/* What further linear systems of Newton's method cost, and what error they
 * leave, without contact: the default of drape_def.newton is read off here.
 * spec/accuracy.md §1 */
#include "bench/accuracy.h"

static const double TIME = 0.5; /* s, of a run: 30 steps of 1/60 s */

static const struct scene {
    enum sample_kind kind;
    double damping;
} scenes[] = {
    {SAMPLE_SWINGING, 0}, {SAMPLE_FALLING, 1e-3}, {SAMPLE_HANGING, 1e-3}};
enum { SCENES = sizeof scenes / sizeof *scenes };

static const int systems[] = {1, 2, 3, 4, 5, 8, 16};
enum { SYSTEMS = sizeof systems / sizeof *systems };

struct count {
    long solves, slices;
};

static bool count(void *user, drape_world *world,
                  const drape_step_report *report)
{
    struct count *c = user;
    (void)world;
    c->solves += report->work.solves;
    c->slices += report->slices;
    return true;
}

static double point(struct bench *b, FILE *out, struct sample *s, int steps,
                    const struct run *exact)
{
    struct run r;
    struct count c = {0};
    s->def.dt = TIME / steps;
    run_watched(b, &s->def, steps, count, &c, &r);
    double error = run_distance(&r, exact, (int64_t)s->cloth.m * s->cloth.n);
    fprintf(out, "%s,%d,%.9g,%ld,%ld,%lld,%.4g,%.3e,%s\n",
            integrator_name[s->def.integrator], s->def.newton, s->def.dt,
            c.slices, c.solves, (long long)r.iterations, r.seconds, error,
            run_word(&r));
    fflush(out);
    run_free(&r);
    return error;
}

static void curves(struct bench *b, FILE *out, enum sample_kind kind,
                   struct sample *s, const struct run *exact)
{
    double error[SYSTEMS];
    s->def.precision = 32;
    for (int m = DRAPE_BW; m <= DRAPE_BDF2; m++)
        for (int steps = 30; steps <= (b->quick ? 30 : 480); steps *= 4)
            for (int k = 0; k < SYSTEMS; k++) {
                s->def.integrator = m;
                s->def.newton = systems[k];
                if (m == DRAPE_CK) /* with more systems it is BDF2 */
                    continue;
                fprintf(out, "%s,", sample_name[kind]);
                error[k] = point(b, out, s, steps, exact);
                /* One system may be as near by chance. */
                bench_check(b,
                            k < 4 || m != DRAPE_BDF2 || steps > 30 ||
                                error[k] <= 1.05 * error[0],
                            "%s: %d systems are further off than one",
                            sample_name[kind], systems[k]);
            }
}

void part_newton(struct bench *b)
{
    FILE *out = bench_csv(b, "newton",
                          "scene,integrator,newton,dt,slices,solves,"
                          "iterations,seconds,rms m,end");
    int side = b->quick ? 9 : 17;
    for (int k = 0; k < (b->quick ? 1 : SCENES); k++) {
        struct sample s;
        struct run exact;
        sample_make(&s, scenes[k].kind, side);
        s.cloth.material.damping = scenes[k].damping;
        run_converged(b, &s, TIME, b->quick ? 2048 : 8192, &exact);
        curves(b, out, scenes[k].kind, &s, &exact);
        run_free(&exact);
        sample_free(&s);
    }
    fclose(out);
}
