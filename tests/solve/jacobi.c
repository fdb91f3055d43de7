/* SPDX-License-Identifier: Apache-2.0 */
/* Stage jacobi: generator and properties. spec/solve/jacobi.md */
#include "ref/solve/jacobi.h"

#include <stdlib.h>

#include "tests/solve/system.h"

const struct field fields_jacobi[] = {IN(jacobi, mass, count, 1),
                                      IN(jacobi, extra, n_extra, 1),
                                      IN(jacobi, block, n_blocks, 1),
                                      IN(jacobi, packed, n_packed, 1),
                                      IN(jacobi, fixed, count, 1),
                                      OUT(jacobi, factor, count, 1),
                                      FIELD_END};

void gen_jacobi(struct bytes *b, struct jacobi *s)
{
    struct system a;
    pick_system(b, &a);
    GIVE_SYSTEM(s, &a);
    s->n_packed = pick(b, 2) ? a.n_blocks : 0;
    s->packed = a.packed;
    s->fixed = a.fixed;
}

/* §2: L D Lᵀ differs from the block by at most 40 u·trace. */
static const char *expect_product(sym f, mat block)
{
    const double u = REAL_BITS == 32 ? 0x1p-24 : 0x1p-53;
    double d[3] = {1 / (double)f.xx, 1 / (double)f.yy, 1 / (double)f.zz};
    double l[3][3] = {
        {1, 0, 0}, {(double)f.xy, 1, 0}, {(double)f.xz, (double)f.yz, 1}};
    double a[3][3] = {
        {(double)block.x.x, (double)block.x.y, (double)block.x.z},
        {(double)block.y.x, (double)block.y.y, (double)block.y.z},
        {(double)block.z.x, (double)block.z.y, (double)block.z.z}};
    double trace = a[0][0] + a[1][1] + a[2][2];
    EXPECT(f.xx > 0 && f.yy > 0 && f.zz > 0);
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 3; c++) {
            double sum = 0;
            for (int k = 0; k < 3; k++)
                sum += l[r][k] * d[k] * l[c][k];
            EXPECT(fabs(sum - a[r][c]) <= 40 * u * trace);
        }
    return NULL;
}

static const char *expect_none(sym f)
{
    vec z = factor_solve(f, vec_make(1, 2, 3));
    EXPECT(f.xx == 0 && f.yy == 0 && f.zz == 0 && f.xy == 0);
    EXPECT(z.x == 0 && z.y == 0 && z.z == 0);
    return NULL;
}

const char *prop_jacobi(const struct jacobi *s)
{
    struct system a = {.m = s->m,
                       .n = s->n,
                       .count = s->count,
                       .n_extra = s->n_extra,
                       .n_blocks = s->n_blocks,
                       .mass = (real *)s->mass,
                       .extra = (sym *)s->extra,
                       .block = (sym *)s->block};
    sym *brief = calloc((size_t)s->n_packed + 1, sizeof *brief);
    for (int64_t k = 0; k < s->n_packed; k++)
        brief[k] = packed_sym(s->packed[k]);
    a.block = s->n_packed ? brief : a.block;
    const char *failed = NULL;
    for (int64_t p = 0; p < s->count && !failed; p++) {
        sym f = s->factor[p];
        failed = s->fixed[p] ? expect_none(f)
                             : expect_product(f, dense_entry(&a, p, p));
    }
    free(brief);
    return failed;
}

/* §2: a block without a positive trace gets the factor 0; a pivot that cancels
 * is raised to the noise of rounding. */
const char *test_factor_singular(void)
{
    struct wide_sym none = {{0, 0, 0, 0, 0, 0}};
    struct wide_sym wrong = {{-1, 0, 0, -1, 0, -1}};
    struct wide_sym lost = {{0.0 / 0.0, 0, 0, 1, 0, 1}};
    struct wide_sym line = {{1, 1, 0, 1, 0, 0}}; /* (1 1 0)ᵀ(1 1 0) */
    sym f = ref_factor(none), g = ref_factor(wrong), h = ref_factor(lost);
    EXPECT(f.xx == 0 && f.yy == 0 && f.zz == 0);
    EXPECT(g.xx == 0 && g.yy == 0 && g.zz == 0);
    EXPECT(h.xx == 0 && h.yy == 0 && h.zz == 0);
    f = ref_factor(line);
    EXPECT(f.xx == 1 && f.xy == 1);
    EXPECT(f.yy == f.zz && f.yy > R(0x1p20) && f.yy <= R(0x1p55));
    ran(4);
    return NULL;
}
