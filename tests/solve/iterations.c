/* SPDX-License-Identifier: Apache-2.0 */
/* The number of iterations that multigrid needs. spec/solve/multigrid.md §6 */
#include <stdio.h>
#include <stdlib.h>

#include "tests/solve/solver.h"

/* Returns the iterations to a true relative residual of 1e-3, or limit + 1.
 * every: if not 0, contacts hold one particle in `every`. */
static int32_t iterations(const struct design *d, uint32_t every, int32_t limit)
{
    struct system a;
    struct pcg s = {.precond = DRAPE_MULTIGRID,
                    .form = DRAPE_COMPACT,
                    .tolerance = R(1e-3),
                    .max_iterations = limit};
    make_system(d, &a);
    if (every)
        hold_system(&a, every);
    solver_open(&s, &a);
    int status = ref_pcg(&s);
    bool good = status == DRAPE_OK && s.outcome == PCG_CONVERGED &&
                s.residual <= s.tolerance && !s.fell_back;
    solver_close(&s);
    free_system(&a);
    ran(1);
    if (getenv("DRAPE_ITERATIONS"))
        printf("%d bits, %s, %d x %d, shape %d, trim %d: %d iterations\n",
               REAL_BITS, d->bending == DRAPE_TRIPLES ? "triples" : "springs",
               d->m, d->n, (int)d->shape, d->trim, s.iterations);
    return good ? s.iterations : limit + 1;
}

/* The sharp folds have positions that are uneven by 5 % of a cell, as cloth in
 * motion has; perfectly isometric folds need more iterations (§6). */
static double uneven_of(int shape)
{
    return shape == SHAPE_FOLDED ? 0.05 : 0;
}

static const int trims[] = {TRIM_NONE,
                            TRIM_HOLE,
                            TRIM_CUT,
                            TRIM_PINS,
                            TRIM_SLIT | TRIM_MOTHS,
                            TRIM_HOLE | TRIM_CUT | TRIM_MOTHS | TRIM_PINS};

/* §6: 20 thousand triangles, in every shape and with every trim. */
const char *test_multigrid_20k(void)
{
    int n = (int)(sizeof trims / sizeof *trims);
    for (int k = 0; k < 2 * SHAPES * n; k++) {
        int shape = k / n % SHAPES;
        struct design d = {101,
                           101,
                           (enum shape)shape,
                           trims[k % n],
                           uneven_of(shape),
                           k / n / SHAPES};
        EXPECT(iterations(&d, 0, 30) < 15);
    }
    return NULL;
}

/* §6: other sizes, neither powers of two nor square. */
const char *test_multigrid_sizes(void)
{
    static const int32_t sizes[][2] = {{254, 259}, {63, 1008}, {2, 300}};
    for (int k = 0; k < 3; k++)
        for (int t = 0; t < 4; t++) {
            struct design d = {sizes[k][0],
                               sizes[k][1],
                               t % 2 ? SHAPE_DRAPED : SHAPE_WRINKLED,
                               t % 2 ? TRIM_HOLE | TRIM_PINS : TRIM_NONE,
                               0,
                               t / 2};
            EXPECT(iterations(&d, 0, 30) < 15);
        }
    return NULL;
}

/* §6: 2 million triangles. Bilinear interpolation is too rough for bending, so
 * triples need more iterations where nothing but bending and mass resists. */
const char *test_multigrid_2m(void)
{
    if (!getenv("DRAPE_SOAK"))
        return skip("2 million triangles take a minute: set DRAPE_SOAK");
    for (int k = 0; k < 2 * SHAPES; k++) {
        int shape = k % SHAPES, bending = k / SHAPES;
        struct design d = {1008,
                           1008,
                           (enum shape)shape,
                           shape ? TRIM_HOLE | TRIM_PINS : TRIM_NONE,
                           uneven_of(shape),
                           bending};
        int32_t limit = bending == DRAPE_TRIPLES ? 40 : 15;
        EXPECT(iterations(&d, 0, 50) < limit);
    }
    return NULL;
}

/* §4: with few or with many contacts the cycle stays positive definite. */
const char *test_multigrid_contacts(void)
{
    for (int shape = 0; shape < SHAPES; shape++)
        for (uint32_t every = 1; every <= 1000; every *= 10) {
            struct design d = {101,
                               101,
                               (enum shape)shape,
                               trims[shape],
                               uneven_of(shape),
                               DRAPE_TRIPLES};
            EXPECT(iterations(&d, every, 40) < 30);
        }
    return NULL;
}
