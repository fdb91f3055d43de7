/* SPDX-License-Identifier: Apache-2.0 */
/* Measures products with both forms of the matrix, and solves to a range of
 * tolerances, in one precision. spec/accuracy.md §8 */
#include "bench/stages.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "bench/bench.h"
#include "ref/solve/product.h"
#include "tests/solve/solver.h"

/* Returns the seconds of a product: the least of 15. */
static double time_product(struct product *p)
{
    double least = 1e9;
    for (int k = 0; k < 15; k++) {
        double start = bench_clock();
        ref_product(p);
        double t = bench_clock() - start;
        least = t < least ? t : least;
    }
    return least;
}

int stages_products(FILE *out, int quick)
{
    int differ = 0;
    for (int side = 33; side <= (quick ? 33 : 513); side = 2 * side - 1) {
        struct design design = {side,      side, SHAPE_DRAPED,
                                TRIM_NONE, 0.05, DRAPE_TRIPLES};
        struct system a;
        make_system(&design, &a);
        struct cdf cdf = ref_cdf(side, side);
        struct matrix m = {side,       side,    a.count,    a.mass, 0,   NULL,
                           a.n_blocks, a.block, cdf.blocks, NULL,   NULL};
        m.diagonal = calloc((size_t)a.count, sizeof *m.diagonal);
        m.cdf = calloc((size_t)m.n_cdf, sizeof *m.cdf);
        vec *y[2];
        struct product p = {
            .m = side, .n = side, .count = a.count, .mass = a.mass, .x = a.b};
        double seconds[2];
        ref_matrix(&m);
        for (int k = 0; k < 2; k++) {
            y[k] = calloc((size_t)a.count, sizeof *y[k]);
            p.y = y[k];
            p.n_blocks = k ? a.n_blocks : 0;
            p.block = k ? a.block : NULL;
            p.n_cdf = k ? 0 : m.n_cdf;
            p.cdf = k ? NULL : m.cdf;
            seconds[k] = time_product(&p);
        }
        differ += memcmp(y[0], y[1], (size_t)a.count * sizeof **y) != 0;
        double size[2] = {(double)m.n_cdf * sizeof(mat),
                          (double)a.n_blocks * sizeof(sym)};
        for (int k = 0; k < 2; k++) {
            fprintf(out, "%d,%d,%s,%.4g,%.4g,%.3f\n", REAL_BITS, side,
                    k ? "compact" : "cdf", 1e3 * seconds[k], 1e-6 * size[k],
                    seconds[0] / seconds[k]);
            free(y[k]);
        }
        free(m.diagonal);
        free(m.cdf);
        free_system(&a);
    }
    return differ;
}

static void solve(FILE *out, const struct system *a, const char *shape,
                  struct pcg *s, int *missed)
{
    solver_open(s, a);
    double start = bench_clock();
    ref_pcg(s);
    fprintf(out, "%d,%d,%s,%s,%.0e,%d,%.3e,%.3e,%s,%.4g\n", REAL_BITS, s->m,
            shape, s->precond ? "multigrid" : "jacobi", (double)s->tolerance,
            s->iterations, (double)s->recurrence, (double)s->residual,
            s->outcome == PCG_CONVERGED ? "converged"
            : s->outcome == PCG_STALLED ? "stalled"
                                        : "limit",
            1e3 * (bench_clock() - start));
    *missed += s->outcome == PCG_CONVERGED && !(s->residual <= s->tolerance);
    solver_close(s);
}

int stages_solves(FILE *out, int quick)
{
    static const char *const name[] = {"flat",     "tilted", "stretched",
                                       "wrinkled", "folded", "draped"};
    int missed = 0;
    for (int side = 33; side <= (quick ? 33 : 129); side = 2 * side - 1)
        for (int shape = SHAPE_WRINKLED; shape <= SHAPE_DRAPED; shape += 2) {
            struct design design = {side,      side, (enum shape)shape,
                                    TRIM_PINS, 0.05, DRAPE_TRIPLES};
            struct system a;
            make_system(&design, &a);
            for (int precond = 0; precond < 2; precond++)
                for (int t = 1; t <= 12; t += quick ? 4 : 1) {
                    struct pcg s = {.precond = precond,
                                    .form = DRAPE_COMPACT,
                                    .tolerance = (real)pow(10, -t),
                                    .max_iterations = 2000};
                    solve(out, &a, name[shape], &s, &missed);
                }
            free_system(&a);
        }
    return missed;
}
