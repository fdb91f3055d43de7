/* SPDX-License-Identifier: Apache-2.0 */
/* Makes maps of stability: dt against stiffness for each integrator. Each cell
 * says how the library's run ended, and how a run without the library's limit
 * of the step ended. spec/accuracy.md §3 */
#include "bench/accuracy.h"

#include <math.h>
#include <string.h>

#include "bench/forced.h"

enum { STEPS = 200, SIDE = 7 };

/* Returns the longest step that the library takes without substeps, s. It is
 * found from the error of a long step, which says how many substeps it needs.
 * 0: the integrator is never stable; infinite: it is implicit. */
static double limit_of(struct bench *b, const drape_def *def)
{
    drape_def d = *def;
    d.dt = 100;
    d.max_substeps = 1;
    struct run r;
    run_scene(b, &d, 0, &r);
    run_free(&r);
    const char *from = strstr(r.text, "stable from ");
    long n = 0;
    if (!from || sscanf(from, "stable from %ld", &n) != 1)
        return INFINITY;
    return n == 2147483647 ? 0 : d.dt / (double)n;
}

static void cell(struct bench *b, FILE *out, struct sample *s, double limit)
{
    struct run r;
    const drape_def *d = &s->def;
    const drape_material *a = &s->cloth.material;
    run_scene(b, d, b->quick ? 40 : STEPS, &r);
    bool implicit = d->integrator >= DRAPE_BW;
    const char *word = run_word(&r), *forced = "";
    bool good = implicit ? strcmp(word, "refused") != 0
                         : !strcmp(word, d->dt < limit ? "stable" : "refused");
    bench_check(b, good, "%s, stretch %g, damping %g, dt %g, limit %g: %s",
                integrator_name[d->integrator], a->stretch, a->damping, d->dt,
                limit, word);
    if (!implicit && b->backend == DRAPE_REF)
        forced = forced_run(b, s, b->quick ? 40 : 4 * STEPS);
    fprintf(out, "%g,%s,%d,%g,%g,%.4g,%s,%lld,%.3g,%s\n", a->damping,
            integrator_name[d->integrator], d->precision, a->stretch, d->dt,
            limit, word, (long long)r.steps, r.residual, forced);
    run_free(&r);
}

/* Makes one map: stiffness by decades, dt by half decades. */
static void map(struct bench *b, FILE *out, int integrator, double damping)
{
    int each = b->quick ? 3 : 1;
    for (int k = 0; k <= 7; k += each) {
        struct sample s;
        sample_make(&s, SAMPLE_STRETCHED, SIDE);
        s.def.integrator = integrator;
        s.def.max_substeps = 1;
        s.cloth.material.stretch = pow(10, k);
        s.cloth.material.shear = 0.3 * pow(10, k);
        s.cloth.material.damping = damping;
        double limit = limit_of(b, &s.def);
        for (int h = -10; h <= -2; h += each) {
            s.def.dt = (h % 2 ? 3.16228 : 1) * pow(10, floor(h / 2.0));
            cell(b, out, &s, limit);
        }
        fflush(out);
        sample_free(&s);
    }
}

void part_stability(struct bench *b)
{
    FILE *out = bench_csv(b, "stability",
                          "damping s,integrator,precision,stretch N/m,dt,"
                          "limit s,end,steps,residual,without the limit");
    for (int m = DRAPE_EULER; m <= DRAPE_CK; m++)
        for (int damped = 0; damped < 2; damped++)
            map(b, out, m, damped * 1e-4);
    fclose(out);
}
