/* SPDX-License-Identifier: Apache-2.0 */
/* The block-Jacobi preconditioner: factored diagonal blocks.
 * spec/solve/jacobi.md */
#include "ref/solve/jacobi.h"

/* §2: a pivot below this share of the trace is rounding error of the blocks. */
#if REAL_BITS == 32
static const double noise = 0x1p-26;
#else
static const double noise = 0x1p-55;
#endif

static double safe_pivot(double d, double least)
{
    return d > least ? d : least;
}

sym ref_factor(struct wide_sym d)
{
    sym f = {0, 0, 0, 0, 0, 0};
    double least = noise * (d.a[0] + d.a[3] + d.a[5]);
    if (!(least > 0))
        return f;
    double x = safe_pivot(d.a[0], least);
    double xy = d.a[1] / x, xz = d.a[2] / x;
    double y = safe_pivot(d.a[3] - xy * d.a[1], least);
    double yz = (d.a[4] - xy * d.a[2]) / y;
    double z = safe_pivot((d.a[5] - xz * d.a[2]) - yz * yz * y, least);
    f.xx = (real)(1 / x);
    f.xy = (real)xy;
    f.xz = (real)xz;
    f.yy = (real)(1 / y);
    f.yz = (real)yz;
    f.zz = (real)(1 / z);
    return f;
}

static struct wide_sym add_spring(const struct jacobi *s, struct wide_sym d,
                                  int64_t k)
{
    return s->n_packed ? wide_sym_packed(d, s->packed[k])
                       : wide_sym_add(d, s->block[k]);
}

/* §1: returns the diagonal block of p, at (i, j). */
static struct wide_sym diagonal_block(const struct jacobi *s, int32_t i,
                                      int32_t j)
{
    int64_t p = i + (int64_t)s->m * j;
    double mass = (double)s->mass[p];
    struct wide_sym d = {{mass, 0, 0, mass, 0, mass}};
    if (s->n_extra)
        d = wide_sym_add(d, s->extra[p]);
    for (int o = 0; o < SPRINGS; o++) {
        int64_t k = o * s->count + p;
        if (spring_inside(s->m, s->n, i, j, o, 1))
            d = add_spring(s, d, k);
        if (spring_inside(s->m, s->n, i, j, o, -1))
            d = add_spring(s, d, k - spring_step(s->m, o));
    }
    return d;
}

int ref_jacobi(struct jacobi *s)
{
    EACH_ITEM
    for (int32_t j = 0; j < s->n; j++)
        for (int32_t i = 0; i < s->m; i++) {
            int64_t p = i + (int64_t)s->m * j;
            sym none = {0, 0, 0, 0, 0, 0};
            s->factor[p] =
                s->fixed[p] ? none : ref_factor(diagonal_block(s, i, j));
        }
    return DRAPE_OK;
}
