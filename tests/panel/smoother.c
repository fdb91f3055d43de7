/* SPDX-License-Identifier: Apache-2.0 */
/* The bound of multigrid's smoothing holds for panels.
 * spec/solve/multigrid.md §4 */
#include "ref/solve/jacobi.h"
#include "ref/solve/product.h"
#include "tests/cloth/sheet.h"
#include "tests/panel/cutting.h"

/* The largest eigenvalue of F A at rest, by power iteration, in steps of tau.
 * It is from below. */
static double largest(struct model *s, double tau)
{
    int64_t n = s->c.count;
    model_blocks(s, tau);
    sym *factor = arena_take(&s->arena, ARENA_OTHER, n, sizeof *factor);
    struct jacobi j = {.m = s->c.m,
                       .n = s->c.n,
                       .count = n,
                       .mass = s->c.mass,
                       .n_blocks = SPRINGS * n,
                       .block = s->block,
                       .fixed = s->c.fixed,
                       .factor = factor};
    struct product a = {.m = s->c.m,
                        .n = s->c.n,
                        .count = n,
                        .mass = s->c.mass,
                        .n_blocks = SPRINGS * n,
                        .block = s->block,
                        .x = s->v,
                        .y = s->f};
    ref_jacobi(&j);
    uint32_t state = 7;
    double value = 0;
    for (int64_t p = 0; p < n; p++) {
        state = state * 1664525u + 1013904223u;
        double r = (double)(state >> 8) / (1 << 23) - 1;
        s->v[p] =
            vec_make((real)r, (real)(0.7 * r * r - 0.2), (real)(r * r - 0.3));
    }
    for (int turn = 0; turn < 60; turn++) {
        double before = 0, after = 0;
        ref_product(&a);
        for (int64_t p = 0; p < n; p++) {
            vec z = factor_solve(factor[p], s->f[p]);
            before += (double)vec_dot(s->v[p], s->v[p]);
            after += (double)vec_dot(z, z);
            s->v[p] = z;
        }
        value = sqrt(after / before);
        for (int64_t p = 0; p < n; p++)
            s->v[p] = vec_scale((real)(1 / sqrt(after)), s->v[p]);
    }
    return value;
}

/* multigrid.md §4: the eigenvalues of F A on the finest grid are at most 2.7 on
 * random strips and discs, where membrane or bending rules. */
const char *test_panel_smoother(void)
{
    double most = 0;
    for (int k = 0; k < 40; k++) {
        struct cutting c;
        struct model s;
        double turn = 0.037 * k + 0.01, h = 0.01;
        EXPECT(k % 5 ? cutting_strip(&c, 0.15 + 0.0031 * k, 0.07, turn, h)
                     : cutting_disc(&c, 0.05 + 0.0017 * k, h));
        c.cloth.material.stretch = 1000;
        c.cloth.material.shear = 300;
        c.cloth.material.bend = k % 3 ? 1e-4 : 1;
        EXPECT(model_make(&s, &c) == DRAPE_OK);
        double is = largest(&s, 1.0 / 60);
        most = is > most ? is : most;
        model_free(&s);
        cutting_free(&c);
        ran(1);
    }
    EXPECT(most <= 2.7);
    return NULL;
}
